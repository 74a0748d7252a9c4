"""Images whose blocks meet as on a checkerboard, where errors fall so slowly that split voxels tell little.

Where good and bad conductors alternate around an edge errors fall with twice the power of the field there
(`demheat.scene.edges`): what halves of voxels change is 2^order - 1 of what is left, a fifth at contrast 100, a
seventeenth at 1000. In noise such edges are few among others, of which that is not asked.
"""

import numpy as np

from demheat.scene.edges import power

# Part of the corners of an image from which on they tell its error; noise has a fifth.
MOST = 0.5
# Contrast of phases at a corner beyond which no size of voxels tells anything: two to the order is 1.005.
BEYOND = 1e5


def left_by_boards(scene) -> float:
    """What is left of an image's error over what voxels split in two change, if its corners are those of boards; or 0.

    Raises NotImplementedError where their contrast leaves nothing to go by.
    """
    if scene.anisotropic:
        return 0.0
    around, counts = _corners(scene.image.labels, np.array(list(scene.image.materials)))
    k = scene.mean_conductivities[around]
    alike = (around[:, 0] == around[:, 2]) & (around[:, 1] == around[:, 3])
    if counts[alike].sum() <= MOST * counts.sum():
        return 0.0
    k, counts = k[alike], counts[alike]
    if np.any(k.max(axis=1) > BEYOND * k.min(axis=1)):
        raise NotImplementedError(
            "Field.error: voxels meet as on a checkerboard of a contrast beyond 1e5, where split ones tell nothing"
        )
    return float(np.average([1 / (2 ** (2 * power(each)) - 1) for each in k], weights=counts))


def _corners(labels, known):
    """Phases around edges at which faces meet at an angle, in turn, (m, 4) int array, and how many such edges are."""
    found = []
    for axis in range(3):
        plane = np.moveaxis(labels, axis, 2)
        turn = plane[:-1, :-1], plane[1:, :-1], plane[1:, 1:], plane[:-1, 1:]
        bent = ~(((turn[0] == turn[1]) & (turn[2] == turn[3])) | ((turn[1] == turn[2]) & (turn[3] == turn[0])))
        phases = tuple(np.searchsorted(known, each[bent]) for each in turn)
        # One number of four: rows would be sorted ten times as slowly.
        found.append(np.ravel_multi_index(phases, (len(known),) * 4))
    numbers, counts = np.unique(np.concatenate(found), return_counts=True)
    return np.stack(np.unravel_index(numbers, (len(known),) * 4), axis=1), counts
