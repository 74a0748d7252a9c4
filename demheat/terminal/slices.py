"""Planes through a body: a grid of points on one, and what any Field has there, ready for a picture."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from demheat.field import Field, check_field
from demheat.runtime.limits import check_memory
from demheat.scene import check_scene
from demheat.scene.bodies import inside
from demheat.scene.inputs import axis_number, finite, reals, whole

# Least bytes that a pixel takes: its middle, and where it is in the body.
BYTES = 50


class Slice(NamedTuple):
    """A Field on the grid of a plane, not-a-number outside the body.

    Rows go along the later one of the plane's two axes and columns along the earlier one (the plane across z has its
    rows along y and its columns along x), from low to high coordinates.
    """

    temperature: np.ndarray  # (rows, columns) float array, K or degrees Celsius
    flux: np.ndarray  # (rows, columns, 3) float array, W/m2


def plane(scene, *, axis, at, n=61):
    """Points of a grid over a plane, the middles of its pixels, where they lie in the body."""
    check_scene(scene)
    axis = axis_number(axis)
    length = scene.size[axis]
    finite("at", at, f"between 0 and {length} m, the box along axis {axis}", lambda v: 0 <= v <= length)
    whole("n", n, "an integer >= 1", lambda v: v >= 1)
    across = [other for other in range(3) if other != axis]
    sides = [scene.size[other] for other in across]
    # In whole numbers, which do not overflow.
    check_memory("n", n, BYTES * int(n) * max(1, int(n) * int(1000 * min(sides) / max(sides)) // 1000), power=2)
    pixel = max(sides) / n
    middles = [_middles(scene.size[other], pixel) for other in across]
    grid = np.empty((len(middles[1]), len(middles[0]), 3))
    grid[..., axis] = at
    grid[..., across[0]], grid[..., across[1]] = np.meshgrid(*middles)
    mask = inside(grid, scene.domain, scene.size)
    if not mask.any():
        raise ValueError(f"at = {at!r}, n = {n!r}: none of the pixels' middles lies in the {scene.domain}")
    return grid[mask], mask


def on_plane(field: Field, *, axis, at, n=61, flux_at: Callable[[np.ndarray], np.ndarray] | None = None) -> Slice:
    """Temperature and flux of a Field on the grid of `plane`.

    Parameters
    ----------
    field : Field
        Of any method.
    axis, at, n
        As those of `plane`.
    flux_at : callable (n, 3) float array, m -> (n, 3) float array, W/m2, optional
        Instead of the Field's own, for instance a halo's.

    Examples
    --------
    >>> from demheat import gallery
    >>> from demheat.terminal.slices import on_plane
    >>> from references import exact
    >>> on_plane(exact.solve(gallery.sphere_in_cube(5.0)), axis=2, at=0.05, n=11).flux.shape
    (11, 11, 3)
    """
    check_field(field)
    if flux_at is not None and not callable(flux_at):
        raise ValueError(f"flux_at = {flux_at!r}: must be a function of points, or None")
    points, mask = plane(field.scene, axis=axis, at=at, n=n)
    flux = reals("flux_at(points)", (flux_at or field.flux_at)(points.copy()), "real numbers, three for each point")
    if flux.shape != points.shape:
        raise ValueError(f"flux_at(points) of shape {flux.shape}: must be {points.shape}, three for each point")
    return Slice(filled(mask, field.temperature_at(points)), filled(mask, flux))


def filled(mask, values):
    """Values of a plane's points put in their pixels, not-a-number elsewhere."""
    mask = np.asarray(mask)
    if mask.dtype != bool or mask.ndim != 2:
        raise ValueError(f"mask of shape {mask.shape}, {mask.dtype}: must be rows of booleans, as `plane` returns it")
    values = reals("values", values, "real numbers, one for each point")
    if values.ndim == 0 or len(values) != np.count_nonzero(mask):
        raise ValueError(f"values of shape {values.shape}: must be one for each of {np.count_nonzero(mask)} points")
    picture = np.full(mask.shape + values.shape[1:], math.nan)
    picture[mask] = values
    return picture


def _middles(length, pixel):
    count = max(1, round(length / pixel))
    return (np.arange(count) + 0.5) / count * length
