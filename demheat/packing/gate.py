"""The one gate for packings: what is made or changed by hand is looked at before kernels, which believe it, are."""

from collections.abc import Mapping

import numpy as np

from demheat.packing.base import MODERATE, Packing, check_box, check_domain
from demheat.scene.bodies import ROUND_AXES, from_middle, round_radius
from demheat.scene.inputs import LEAST, MOST

# Of the box: centres may be so far beyond it, by rounding when a packing is stretched or moved.
ROUNDING = 1e-9


def check_packing(packing, name="packing") -> None:
    """Raise ValueError unless a packing is what `Packing` says it is.

    Of `demheat.packing`, every function that takes a packing asks this first. Linear in the number of particles: some
    10 ns for each.
    """
    if not isinstance(packing, Packing):
        raise ValueError(f"{name} = {packing!r}: must be a Packing")
    centers, radii = (_array(f"{name}.{field}", getattr(packing, field)) for field in ("centers", "radii"))
    if centers.ndim != 2 or centers.shape[1] != 3 or not len(centers):
        raise ValueError(f"{name}.centers of shape {centers.shape}: must be (n, 3), n > 0")
    if radii.shape != (len(centers),):
        raise ValueError(f"{name}.radii of shape {radii.shape}: must be ({len(centers)},), one for each centre")
    _check_body(packing, name)
    # Comparisons with not-a-number are false.
    if not (radii.min() >= LEAST and radii.max() <= MOST):
        which = int(np.argmin((radii >= LEAST) & (radii <= MOST)))
        raise ValueError(f"{name}.radii[{which}] = {radii[which]}: must be a finite length > 0, {MODERATE}")
    _check_inside(packing, name)
    if not isinstance(packing.provenance, Mapping):
        raise ValueError(f"{name}.provenance = {packing.provenance!r}: must be a dict")


def _array(name, value):
    if not isinstance(value, np.ndarray) or isinstance(value, np.ma.MaskedArray) or value.dtype != np.float64:
        what = f"an array of {value.dtype}" if isinstance(value, np.ndarray) else f"a {type(value).__name__}"
        what = "a masked array" if isinstance(value, np.ma.MaskedArray) else what
        raise ValueError(f"{name} is {what}: must be an array of float64; `make_packing` casts")
    return value


def _check_body(packing, name):
    """Box, periods and domain, by the rules of `make_packing`; they must be arrays already."""
    _array(f"{name}.size", packing.size)
    periodic = packing.periodic
    if not isinstance(periodic, np.ndarray) or periodic.shape != (3,):
        raise ValueError(f"{name}.periodic = {periodic!r}: must be a (3,) array of bool")
    try:
        check_box(packing.size, periodic)
        check_domain(packing.domain, packing.size, periodic)
    except ValueError as error:
        raise ValueError(f"{name}.{error}") from None


def _check_inside(packing, name):
    centers, size = packing.centers, packing.size
    slack = ROUNDING * size
    # Axis by axis: the least and the largest of a column cost a tenth of a comparison of all.
    good = all(
        column.min() >= -room and column.max() <= side + room
        for column, side, room in zip(centers.T, size, slack, strict=True)
    )
    good = good and bool(np.all(_in_round(packing)))
    if not good:
        box = np.all((centers >= -slack) & (centers <= size + slack), axis=1)
        which = int(np.argmin(box & _in_round(packing)))
        raise ValueError(
            f"{name}.centers[{which}] = {centers[which].tolist()}: must be finite, in the {packing.domain} from 0 to "
            f"{size.tolist()} m"
        )


def _in_round(packing):
    """Which centres lie within the round wall; all of a box."""
    if not ROUND_AXES[packing.domain]:
        return True
    reach = round_radius(packing.domain, packing.size) * (1 + ROUNDING)
    return from_middle(packing.centers, packing.domain, packing.size) <= reach
