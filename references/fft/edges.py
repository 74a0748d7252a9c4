"""How edges of bodies lie in voxels: what laminates miss beside them goes with that, by chance from grid to grid."""

import numpy as np

from demheat.scene.edges import SMOOTH, edge_order
from demheat.scene.volumes import extents

# Order of errors beside the edge of a blade, the sharpest there is: below it edges meet.
ALONE = 1.0


def hidden(scene, shape) -> np.ndarray:
    """How much of each inclusion edges within voxels hide, over what all of it makes, but for a factor.

    That is the size of a voxel over the width of the body to the power with which errors fall beside edges, times how
    far off the faces of voxels the edges lie: nothing on them, 1 half way between. Where edges meet, and of what goes
    through the whole box, as rods, whose errors fall as coarser grids tell, that is not said: nothing.
    """
    order, voxel = edge_order(scene), np.array(scene.size) / shape
    if not ALONE <= order < SMOOTH:
        return np.zeros(len(scene.inclusions))
    off = np.array([_off(body, scene.size, voxel) for body in scene.inclusions])
    return off * (voxel.max() / extents(scene)) ** order


def _off(body, size, voxel):
    """Mean of how far off the faces of voxels edges are, across themselves; 0 to 1."""
    around = np.concatenate([np.empty((0, 4, 3)), *(part.edges(size) for part in body.parts)])
    low, high = body.bounds()
    if not len(around) or np.any(high - low > np.array(size) - voxel):
        return 0.0
    place = around.mean(axis=1) / voxel
    place -= np.floor(place)
    # Along itself an edge lies everywhere in voxels.
    across = np.ptp(around, axis=1)
    return float(np.mean(np.sum(across * 4 * place * (1 - place), axis=1) / across.sum(axis=1)))
