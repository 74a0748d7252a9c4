"""Images whose blocks meet as on a checkerboard, where errors fall so slowly that split voxels tell little.

Where good and bad conductors alternate around an edge errors fall with twice the power of the field there
(`demheat.scene.edges`): what halves of voxels change is 2^order - 1 of what is left, a fifth at contrast 100, a
seventeenth at 1000. In noise such edges are chance: few of them go on with the voxels beyond.
"""

from collections import Counter

import numpy as np

from demheat.scene.edges import power

# Part of the edges at which faces meet that tells a board: of those that alternate, and of those that do so two voxels
# on, too. Noise has a fifth and an eightieth, fields of lumps a few hundredths.
MOST, GOING_ON = 0.5, 0.1
# Contrast at an edge beyond which no size of voxels tells anything: a hundred times what changes is left.
BEYOND = 1e4
# Conductivities nearer to each other than this factor are one; steps in which they are told apart.
ALIKE, STEP = 1.5, 1.05


def left_by_boards(scene, *, goes_on: bool) -> float:
    """What is left of an image's error over what voxels split in two change, if it is of boards; otherwise 0.

    Whether it goes on beyond its faces as a cell does is to be said: a block out of a cell does not. Raises
    NotImplementedError where their contrast leaves nothing to go by.
    """
    if scene.anisotropic:
        return 0.0
    own, k = _told_apart(scene.mean_conductivities)
    around, onward, counts = _edges(own[scene.image.phase], k, goes_on)
    meets, alternates = _meets(around), _alternates(around)
    bent = counts[meets].sum()
    told = alternates if counts[alternates].sum() > MOST * bent else alternates & onward
    if counts[told].sum() <= GOING_ON * bent:
        return 0.0
    # Of several boards that where errors fall most slowly, but for a tenth that may be specks.
    contrasts = _contrasts(around[told])
    order = np.argsort(-contrasts, kind="stable")
    worst = order[np.searchsorted(np.cumsum(counts[told][order]), GOING_ON * counts[told].sum())]
    if contrasts[worst] > BEYOND:
        raise NotImplementedError(
            f"Field.error: voxels meet as on a checkerboard of a contrast beyond {BEYOND:g}, where split ones tell "
            "nothing"
        )
    return 1 / (2 ** (2 * power(around[told][worst])) - 1)


def _contrasts(k):
    """Of both diagonals around edges, by their geometric means, (m,) float array."""
    with np.errstate(divide="ignore"):
        logs = np.log(k)
        return np.exp(0.5 * np.abs(logs[:, 0] + logs[:, 2] - logs[:, 1] - logs[:, 3]))


def _told_apart(conductivities):
    """Which of a few conductivities each phase has, but for a step, and these, W/(m K)."""
    steps = np.round(np.log(np.maximum(conductivities, 1e-300)) / np.log(STEP))
    _, first, own = np.unique(steps, return_index=True, return_inverse=True)
    return own, conductivities[first]


def _edges(phases, k, goes_on):
    """Conductivities around edges between voxels, in turn, whether they alternate two voxels on, too, and how many."""
    found, shape, end = Counter(), (len(k),) * 4 + (2,), None if goes_on else -1
    for axis in range(3):
        for layer in np.moveaxis(phases, axis, 0):
            near, far = (_turn(layer, *steps)[:end, :end].reshape(-1, 4) for steps in ((0, 1), (-1, 2)))
            here = np.any(near[:, 1:] != near[:, :1], axis=1)
            near, far = near[here], far[here]
            onward = _alternates(k[far]) & _same_way(k[near], k[far])
            numbers = np.ravel_multi_index((*near.T, onward.astype(int)), shape)
            found.update(dict(zip(*np.unique(numbers, return_counts=True), strict=True)))
    *around, onward = np.unravel_index(np.array(list(found), dtype=int), shape)
    return k[np.stack(around, axis=1)], onward > 0, np.array(list(found.values()), dtype=float)


def _turn(layer, before, after):
    """Phases around each edge of a layer, as many voxels before and after it, in turn; its ends meet."""
    corners = ((before, before), (after, before), (after, after), (before, after))
    return np.stack([np.roll(layer, (-one, -other), axis=(0, 1)) for one, other in corners], axis=2)


def _alternates(k):
    """Whether both of one diagonal conduct better than both of the other."""
    one, other = k[..., [0, 2]], k[..., [1, 3]]
    return (one.min(axis=-1) > ALIKE * other.max(axis=-1)) | (other.min(axis=-1) > ALIKE * one.max(axis=-1))


def _same_way(near, far):
    """Whether the same diagonal conducts better."""
    return (near[..., 0] > near[..., 1]) == (far[..., 0] > far[..., 1])


def _meets(k):
    """Whether faces meet there at an angle."""
    apart = np.abs(np.log(np.maximum(k, 1e-300)) - np.log(np.maximum(np.roll(k, -1, axis=1), 1e-300))) > np.log(ALIKE)
    return ~((~apart[:, 0] & ~apart[:, 2]) | (~apart[:, 1] & ~apart[:, 3]))
