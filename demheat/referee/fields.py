"""Errors of one Field against another."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from demheat.field import check_field
from demheat.referee.values import rms, value_error, vector_error, worst
from demheat.scene import check_scene
from demheat.scene.inputs import chosen, finite, flag, reals

if TYPE_CHECKING:
    from demheat.field import Field
    from demheat.scene import Scene

Mask = np.ndarray | Callable[[np.ndarray], np.ndarray]


class Error(NamedTuple):
    """A field error over many points."""

    values: np.ndarray  # (n,) float array: Signed, or sizes of vectors
    points: np.ndarray  # (n, 3) float array, m
    weights: np.ndarray | None  # (n,) float array, m3, or None: Volumes; None if all points weigh the same

    @property
    def rms(self) -> float:
        """Root of the weighted mean square."""
        return rms(self.values, self.weights)

    @property
    def max(self) -> float:
        """Largest size; not-a-number if one of the values is."""
        return abs(worst(self.values)[1])

    @property
    def where(self) -> np.ndarray:
        """Point of the largest error, (3,) float array, m."""
        return self.points[worst(self.values)[0]]

    def part(self, mask: np.ndarray) -> Error:
        """The same over some of the points, those of a (n,) bool array; raises ValueError for anything else."""
        mask = np.asarray(mask)
        if mask.dtype != bool or mask.shape != (len(self.points),):
            raise ValueError(f"mask of shape {mask.shape}, {mask.dtype}: must be {len(self.points)} booleans")
        return Error(self.values[mask], self.points[mask], None if self.weights is None else self.weights[mask])


def conductivity_error(field: Field, reference: Field | float) -> float:
    """Signed relative error of the effective conductivity.

    Parameters
    ----------
    field : Field
    reference : Field or float
        A Field, or a conductivity in W/(m K).

    Raises
    ------
    ValueError
        Unless the reference's conductivity is finite and positive.

    Examples
    --------
    >>> from demheat import gallery, referee
    >>> from references import exact, fft
    >>> scene = gallery.sphere_in_cube(5.0)
    >>> abs(referee.conductivity_error(fft.solve(scene, voxels=32), exact.solve(scene))) < 1e-3
    True
    """
    if not hasattr(field, "conductivity"):
        raise ValueError(f"field = {field!r}: must be a Field, or have a conductivity")
    exact = getattr(reference, "conductivity", reference)
    finite("reference conductivity", exact, "finite and > 0, a relative error follows from it", lambda v: v > 0)
    return value_error(field.conductivity, exact)


def span(scene: Scene, reference: Field | None = None) -> float:
    """Temperature difference that the load imposes, K.

    The largest difference between walls, or the surroundings that they exchange heat with, in time between them and
    the initial temperature; in a periodic cell that of the mean gradient over the box, sum |g_i| L_i.
    """
    check_scene(scene)
    if reference is not None:
        check_field(reference, "reference")
    if scene.periodic:
        return float(np.abs(scene.gradient) @ np.array(scene.size))
    time = None if reference is None else reference.time
    temperatures = list((scene if time is None else scene.at(time)).imposed_temperatures.values())
    if time is not None and not callable(scene.initial):
        temperatures.append(float(scene.initial))
    if len(temperatures) < 2 and reference is not None:
        temperatures += reference.wall_temperature.values()
    if not temperatures or max(temperatures) == min(temperatures):
        raise ValueError(f"Scene.walls = {dict(scene.walls)}: no temperature difference, no relative error follows")
    return float(max(temperatures) - min(temperatures))


def temperature_error(
    field: Field,
    reference: Field,
    points: ArrayLike | None = None,
    *,
    values: np.ndarray | None = None,
    mask: Mask | None = None,
    unit: str = "span",
) -> Error:
    """Signed error of temperature, of steady fields or of two at one time.

    Parameters
    ----------
    field, reference : Field
    points : (n, 3) float array, m, optional
        Where to compare, all with the same weight; by default the field's own samples, weighted by volume.
    values : (n,) float array, K, optional
        The field's temperatures at the points, if they are at hand already.
    mask : (n,) bool array or callable (n, 3) float array -> (n,) bool array, optional
        Points to use, for instance those away from interfaces.
    unit : {"span", "%", "K"}
        Span that the load imposes, see `span`; a hundredth of it; kelvin.

    Returns
    -------
    Error

    Examples
    --------
    >>> from demheat import gallery, referee
    >>> from references import exact, fft
    >>> scene = gallery.sphere_in_cube(5.0)
    >>> points = [[0.05, 0.03, 0.05], [0.02, 0.08, 0.05]]
    >>> referee.temperature_error(fft.solve(scene, voxels=32), exact.solve(scene), points).max < 5e-3  # of the span
    True
    """
    check_field(field)
    check_field(reference, "reference")
    chosen("unit", unit, ("span", "%", "K"))
    points, weights, values = _compared(field, points, values, mask, "temperature")
    difference = values - reference.temperature_at(points)
    if field.scene.periodic:
        difference = difference - np.average(difference, weights=weights)
    if unit != "K":
        difference = (100 if unit == "%" else 1) * difference / span(field.scene, reference)
    return Error(difference, points, weights)


def flux_error(
    field: Field,
    reference: Field,
    points: ArrayLike | None = None,
    *,
    values: np.ndarray | None = None,
    mask: Mask | None = None,
    unit: str = "mean",
    along: bool = False,
) -> Error:
    """Error of the flux: size of the vector's, or signed of its component along the reference's mean flux.

    Parameters
    ----------
    field, reference : Field
    points, mask
        As those of `temperature_error`.
    values : (n, 3) float array, W/m2, optional
        Fluxes at the points, if they are at hand already or are others than `field.flux_at` gives: a halo's.
    unit : {"mean", "%"}
        Magnitude of the reference's mean flux, or a hundredth of it.
    along : bool
        Compare the component along the reference's mean flux only.

    Returns
    -------
    Error

    Raises
    ------
    ValueError
        If the reference has no mean flux.

    Examples
    --------
    >>> from demheat import gallery, referee
    >>> from references import exact, fft
    >>> scene = gallery.sphere_in_cube(5.0)
    >>> error = referee.flux_error(fft.solve(scene, voxels=32), exact.solve(scene), [[0.05, 0.05, 0.05]])
    >>> error.max < 0.02  # of the mean flux
    True
    """
    check_field(field)
    check_field(reference, "reference")
    chosen("unit", unit, ("mean", "%"))
    flag("along", along)
    scale = np.linalg.norm(reference.mean_flux)
    if scale == 0:
        raise ValueError("reference.mean_flux = 0: no relative error of the flux follows")
    points, weights, values = _compared(field, points, values, mask, "flux")
    right, percent = reference.flux_at(points), 100 if unit == "%" else 1
    if along:
        return Error(percent * ((values - right) @ reference.mean_flux) / scale**2, points, weights)
    return Error(vector_error(values, right) * (percent / scale), points, weights)


def _compared(field, points, values, mask, name):
    """Points, weights (None where all are the same) and the field's values there."""
    weights = None
    if points is None:
        samples = field.samples
        points, weights = samples.points, samples.volumes
        values = getattr(samples, name) if values is None else values
    points = np.atleast_2d(reals("points", points, "(n, 3) coordinates in metres"))
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points of shape {points.shape}: must be (n, 3) coordinates in metres")
    values = None if values is None else reals("values", values, "numbers, one for each point")
    shape = (len(points),) if name == "temperature" else (len(points), 3)
    if values is not None and values.shape != shape:
        raise ValueError(f"values of shape {values.shape}: must be one for each of {len(points)} points, {shape}")
    keep = mask(np.array(points)) if callable(mask) else mask
    if keep is not None:
        keep = np.asarray(keep)
        if keep.dtype != bool or keep.shape != (len(points),):
            raise ValueError(f"mask of shape {keep.shape}, {keep.dtype}: must be {len(points)} booleans")
        points, weights, values = (part if part is None else part[keep] for part in (points, weights, values))
    if not len(points):
        raise ValueError("points: none left to compare")
    return points, weights, getattr(field, name + "_at")(points) if values is None else values
