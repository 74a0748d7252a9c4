"""Halo averages: the flux at a point as a mean over the particles around it.

Source: Haddad et al. 2021, eqs. 22-23.
"""

from collections.abc import Sequence

import numpy as np

import demheat.runtime.threads  # noqa: F401 (chooses the threading layer)
from demheat.field import Field, Samples, check_field
from demheat.network.bins import bin_points
from demheat.runtime.blocks import blocks
from demheat.runtime.progress import stage
from demheat.sampling import halo_kernels as kernels
from demheat.scene import ROUND_AXES, STEFAN_BOLTZMANN, Convection
from demheat.scene.bodies import inside
from demheat.scene.inputs import LEAST, MOST, check_rows, chosen, finite, flag, moderate, points_of, reals, vector

# Sides of the cells: this part of the radius, but no fewer samples to a cell on average than this. Cheapest of 1 to 1/4
# and 1 to 8 for 1e5 points and radii of 2 to 15 mean radii; sides of a whole or a third of the radius cost up to twice.
PART, FEWEST = 1 / 2, 8.0
WALLS = ("clip", "mirror")


def halo_average(
    points: np.ndarray,
    values: np.ndarray,
    volumes: np.ndarray,
    *,
    radius: float,
    size: Sequence[float],
    periodic: bool | Sequence[bool],
    at: np.ndarray | None = None,
    phases: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Mean of values over the samples whose centres lie within a radius, weighted by volume.

    sum(volumes * values) / sum(volumes) over all samples with |x - x_at| <= radius (Haddad et al. 2021, eqs. 22-23,
    volumes being V_r / phi). Neither lists of neighbours nor anything else that grows with the radius is kept.
    """
    size, periodic = _checked_box(size, periodic)
    radius = _checked_radius(radius, size, periodic)
    points = _inside(points_of("points", points), size, periodic)
    values, volumes = _checked_values(len(points), values, volumes)
    at = points if at is None else _wrapped(points_of("at", at), size, periodic)
    phase, wanted = _checked_phases(len(points), len(at), phases)
    columns = values.reshape(len(points), -1)
    means = np.empty((len(at), columns.shape[1]))
    cells, order = _cells(points, volumes, phase, radius, size, periodic)
    begin, places = (cells.start, order) if at is points else bin_points(at, size, cells.dims)
    sorted_at, wanted, columns = at[places], wanted[places], columns[order]
    with stage("halos") as done:
        for first in range(0, columns.shape[1], 3):
            part = columns[:, first : first + 3]
            out = np.empty((len(at), 3))
            filled, run = _with_values(cells, part), cells.dims[2]
            rows = (len(begin) - 1) // run
            for low, high in blocks(rows, 1):
                kernels.ball_means(sorted_at, begin[low * run : high * run + 1], wanted, radius, filled, out)
                done((first + 3 * low / rows) / (columns.shape[1] + 2))
            means[places, first : first + 3] = out[:, : part.shape[1]]
    return means.reshape(len(at), *values.shape[1:])


def halo_flux(
    field: Field, *, ratio: float = 11.0, walls: str = "clip", same_phase: bool = False, at: np.ndarray | None = None
) -> np.ndarray:
    """Flux of a field of particles, averaged over halos.

    Source: Haddad et al. 2021, eqs. 22-23.

    Parameters
    ----------
    field : Field
        With `mean_radius` among its stats: of a method of particles.
    ratio : float
        Radius of the halo in mean radii of the particles.
    walls : {"clip", "mirror"}
        Halos end at walls; or go on among samples mirrored across flat walls. There the temperature goes on evenly
        from an insulated wall, so that the flux along the wall is even and that across it odd; at an imposed flux, or
        one that is exchanged with surroundings, what exceeds it is odd; at a held temperature what exceeds this is odd,
        the flux across the wall even and that along it odd.
    same_phase : bool
        Only samples of the phase of the point asked for.
    at : (m, 3) float array, m, optional
        Default at the samples.

    Returns
    -------
    (m, 3) float array, W/m2
        NaN where no sample that counts lies within the halo.

    Raises
    ------
    ValueError
        If an argument is not as described, the halo is wider than a periodic cell, or reaches beyond the opposite wall
        with `walls = "mirror"`.
    NotImplementedError
        For mirrors in round bodies.

    Examples
    --------
    >>> from demheat import gallery, solve
    >>> from demheat.sampling.halo import halo_flux
    >>> field = solve(gallery.sphere_in_cube(5.0), particles=1000)
    >>> smooth = halo_flux(field, ratio=2.0)
    >>> bool(smooth[:, 1].std() < field.samples.flux[:, 1].std())
    True
    """
    check_field(field)
    scene = field.scene
    radius = _halo_radius(field, ratio)
    chosen("walls", walls, WALLS)
    flag("same_phase", same_phase)
    if walls == "mirror" and ROUND_AXES[scene.domain]:
        raise NotImplementedError("walls = 'mirror': round walls do not mirror a lattice; use walls = 'clip'")
    at = None if at is None else _checked_at(at, scene)
    points, volumes, warmth, phase, flux = field.samples
    if at is None:
        at, at_phase = points, phase
    else:
        at_phase = scene.phase_at(at)
    size = np.array(scene.size)
    if walls == "mirror" and not scene.periodic:
        if radius > size.min():
            raise ValueError(
                f"ratio = {ratio!r}: a radius of {radius:g} m must be <= the box, {scene.size}, for mirrors"
            )
        now = scene.at(0.0 if field.time is None else field.time)
        points, volumes, phase, flux = _mirrored(now, radius, Samples(points, volumes, warmth, phase, flux))
        points, at, size = points + radius, at + radius, size + 2 * radius
    phases = (phase, at_phase) if same_phase else None
    where = {"radius": radius, "size": size, "periodic": scene.periodic}
    return halo_average(points, flux, volumes, **where, at=at, phases=phases)


def _mirrored(scene, radius, samples):
    """Samples with those within the radius of a wall mirrored across it; edges and corners follow axis by axis."""
    for axis in range(3):
        parts = [samples]
        for side, wall in (("-", 0.0), ("+", scene.size[axis])):
            kept = np.abs(samples.points[:, axis] - wall) <= radius
            near = Samples(*(column[kept] for column in samples))
            image = near.points.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            parts.append(near._replace(points=image, flux=_reflected(scene, axis, side, near)))
        samples = Samples(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    return samples.points, samples.volumes, samples.phase, samples.flux


def _reflected(scene, axis, side, near):
    """Flux behind a wall."""
    name, flux = "xyz"[axis] + side, near.flux.copy()
    if name in scene.wall_temperatures:
        flux *= -1.0
        flux[:, axis] *= -1.0
        return flux
    entering = scene.wall_fluxes.get(name, 0.0)
    if name in scene.wall_exchanges:
        entering = _exchanged(scene, axis, side, near)
    # Into the body at the lower wall is along the axis, at the upper one against it.
    through = entering * (1.0 if side == "-" else -1.0)
    flux[:, axis] = 2 * through - flux[:, axis]
    return flux


def _exchanged(scene, axis, side, near):
    """Flux that surroundings let in before each sample, where its own slope takes its temperature to the wall."""
    load, wall = scene.wall_exchanges["xyz"[axis] + side], 0.0 if side == "-" else scene.size[axis]
    k = scene.conductivities[near.phase]
    slope = -np.divide(near.flux[:, axis], k, out=np.zeros(len(k)), where=k > 0)
    rise = slope * (wall - near.points[:, axis])
    if scene.varies:
        # On the way to the wall Kirchhoff's transform is what is linear.
        own = scene.dependences
        surface = own.inverse(near.phase, own.integral(near.phase, near.temperature) + rise)
    else:
        surface = near.temperature + rise
    if isinstance(load, Convection):
        entering = load.coefficient * (load.temperature - surface)
    else:
        entering = load.emissivity * STEFAN_BOLTZMANN * (load.temperature**4 - surface**4)
    return np.where(k > 0, entering, 0.0)


def _dims(n, size, radius):
    """Cells along each axis."""
    edge = max(radius * PART, np.cbrt(FEWEST * np.prod(size) / max(n, 1)))
    # Of a box that is long and thin, the volume asks for many more cells along it than there are samples.
    return np.clip(np.floor(size / edge), 1, max(n, 1)).astype(np.int64)


def _cells(points, volumes, phase, radius, size, periodic):
    """Samples in the order of their cells, values left out, and that order."""
    dims = _dims(len(points), size, radius)
    start, order = bin_points(points, size, dims)
    slots = np.zeros((kernels.ROWS, len(points)))
    slots[:3] = points[order].T
    slots[kernels.PHASE] = phase[order] if len(phase) else 0.0
    slots[kernels.SUMS] = volumes[order]
    period, totals = np.where(periodic, size, 0.0), np.zeros((len(start) - 1, kernels.ROWS - kernels.SUMS))
    return kernels.Cells(dims, size / dims, period, start, slots, totals, len(phase) > 0), order


def _with_values(cells, values):
    """The same cells with up to three values, in their order; the slots are filled in place."""
    slots, first = cells.slots, kernels.SUMS + 1
    slots[first:] = 0.0
    slots[first : first + values.shape[1]] = values.T * slots[kernels.SUMS]
    return cells._replace(totals=kernels.cell_totals(cells.start, slots))


def _halo_radius(field, ratio):
    finite("ratio", ratio, "a finite number > 0, the halo's radius in mean particle radii", lambda v: v > 0)
    if "mean_radius" not in field.stats:
        raise ValueError("field: its stats have no mean_radius; halos need the field of a method of particles")
    return float(ratio * field.stats["mean_radius"])


def _checked_at(at, scene):
    at = points_of("at", at)
    if not scene.periodic:
        within = inside(at, "box", scene.size) & inside(at, scene.domain, scene.size, slack=1e-9)
        check_rows("at", at, within, f"lies outside the {scene.domain} with walls, 0 to {scene.size}")
    return at


def _checked_box(size, periodic):
    size, flags = np.array(vector("size", size)), np.asarray(periodic)
    if np.any(size <= 0) or not all(map(moderate, size)):
        raise ValueError(f"size = {size.tolist()}: must be three finite lengths > 0, from {LEAST:g} to {MOST:g} m")
    if flags.dtype != bool or flags.shape not in ((), (3,)):
        raise ValueError(f"periodic = {periodic!r}: must be a bool or three bools, one per axis")
    return size, np.broadcast_to(flags, 3)


def _checked_radius(radius, size, periodic):
    finite("radius", radius, "a finite length > 0 m", lambda v: v > 0)
    if np.any(2 * radius > size[periodic]):
        raise ValueError(
            f"radius = {radius:g} m: a halo's diameter must be <= the periodic sides of the box, {size.tolist()} m"
        )
    return float(radius)


def _wrapped(points, size, periodic):
    """Points with periodic coordinates in 0 <= x < size; rounding may take a tiny negative one to size itself."""
    wrapped = points - np.where(periodic, np.floor(points / size) * size, 0.0)
    return np.ascontiguousarray(np.where(periodic & (wrapped >= size), 0.0, wrapped))


def _inside(points, size, periodic):
    """Wrapped samples; there must be some, on walled axes inside the box (to 1e-9 of it: computed to lie on a wall)."""
    if len(points) == 0:
        raise ValueError("points of shape (0, 3): there must be samples to average")
    outside = ~periodic & ((points < -1e-9 * size) | (points > (1 + 1e-9) * size))
    check_rows("points", points, ~outside.any(axis=1), f"lies outside the walls of the box, 0 to {size}")
    return _wrapped(points, size, periodic)


def _checked_values(n, values, volumes):
    values = reals("values", values, f"({n},) or ({n}, d) finite numbers")
    volumes = reals("volumes", volumes, f"{n} finite numbers >= 0, one per sample")
    if values.ndim not in (1, 2) or len(values) != n or not np.all(np.isfinite(values)):
        raise ValueError(f"values of shape {values.shape}: must be ({n},) or ({n}, d) finite numbers")
    if volumes.shape != (n,) or not np.all(np.isfinite(volumes)) or np.any(volumes < 0):
        raise ValueError(f"volumes of shape {volumes.shape}: must be {n} finite numbers >= 0, one per sample")
    return values, volumes


def _checked_phases(samples, wanted, phases):
    """Phases of samples (none if they do not count) and of points, as floats: exact up to 2^53."""
    if phases is None:
        return np.empty(0), np.zeros(wanted)
    if not (isinstance(phases, tuple | list) and len(phases) == 2):
        raise ValueError(
            f"phases = {phases!r}: must be a pair, of the samples and of the points where means are wanted"
        )
    for number, (given, length) in enumerate(zip(phases, (samples, wanted), strict=True)):
        if given is None or np.shape(given) != (length,) or not np.issubdtype(np.asarray(given).dtype, np.integer):
            raise ValueError(f"phases[{number}] = {given!r}: must be {length} whole numbers")
    return tuple(np.asarray(given, dtype=float) for given in phases)
