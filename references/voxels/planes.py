"""Some planes of a grid across its first axis: what reaches them, and what is left of the rest."""

import numpy as np

from demheat.scene import Shape


def reaches(shape: Shape, planes, spacing: float) -> bool:
    """Whether a shape may fill or cut voxels of some planes."""
    if planes is None:
        return True
    low, high = (bound[0] / spacing for bound in shape.bounds())
    # Surfaces are moved by parts of a voxel to keep volumes.
    return low < planes[1] + 1 and high > planes[0] - 1


def kept(phase, cuts, planes) -> tuple:
    """Some planes of a painted grid, and the surfaces in them."""
    if planes is None:
        return phase, cuts
    (low, high), plane = planes, phase[0].size
    here = np.flatnonzero((cuts.index >= low * plane) & (cuts.index < high * plane))
    cuts = cuts._replace(**{name: column[here] for name, column in cuts._asdict().items()})
    return phase[low:high].copy(), cuts._replace(index=cuts.index - low * plane)
