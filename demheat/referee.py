"""Errors of one Field against another and the checks that need no other: what no method imports.

Conventions: errors of conductivity are relative to the reference; of temperature relative to the span that the load
imposes; of flux relative to the magnitude of the reference's mean flux. In a periodic cell the level of temperature is
free, so the mean difference is taken off before temperatures are compared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Error(NamedTuple):
    """A field error over many points.

    Attributes
    ----------
    rms : float
        Root of the volume-weighted mean square.
    max : float
    where : (3,) float array, m
        The point of the largest error.
    """

    rms: float
    max: float
    where: np.ndarray


def conductivity_error(field, reference):
    """Signed relative error of the effective conductivity.

    Parameters
    ----------
    field : Field
    reference : Field or float
        A Field, or a conductivity in W/(m K).

    Returns
    -------
    float
    """
    exact = float(getattr(reference, "conductivity", reference))
    if not (np.isfinite(exact) and exact > 0):
        raise ValueError(f"reference conductivity = {exact}: must be finite and > 0, a relative error follows from it")
    return field.conductivity / exact - 1.0


def span(scene, reference=None):
    """Temperature difference that the load imposes, K.

    The largest difference between walls; in a periodic cell that of the mean gradient over the box, sum |g_i| L_i.
    Where fewer than two walls have a temperature of their own, the walls' mean temperatures of `reference` are used.

    Raises
    ------
    ValueError
        If there is no difference: relative errors of temperature do not follow.
    """
    if scene.periodic:
        return float(np.abs(scene.gradient) @ np.array(scene.size))
    temperatures = list(scene.wall_temperatures.values())
    if len(temperatures) < 2 and reference is not None:
        temperatures = list(reference.wall_temperature.values())
    if not temperatures or max(temperatures) == min(temperatures):
        raise ValueError(f"Scene.walls = {dict(scene.walls)}: no temperature difference, no relative error follows")
    return float(max(temperatures) - min(temperatures))


def temperature_error(field, reference, points=None, *, mask=None):
    """Error of temperature relative to the imposed span.

    Parameters
    ----------
    field, reference : Field
    points : (n, 3) float array, m, optional
        Where to compare, all with the same weight; by default the field's own samples, weighted by volume.
    mask : (n,) bool array or callable (n, 3) float array -> (n,) bool array, optional
        Points to use, for instance those away from interfaces.

    Returns
    -------
    Error
    """
    points, weights, values = _compared(field, points, mask, "temperature")
    difference = values - reference.temperature_at(points)
    if field.scene.periodic:
        difference = difference - np.average(difference, weights=weights)
    return _error(np.abs(difference) / span(field.scene, reference), weights, points)


def flux_error(field, reference, points=None, *, mask=None):
    """Error of the flux vector relative to the reference's mean flux; arguments as `temperature_error`."""
    scale = np.linalg.norm(reference.mean_flux)
    if scale == 0:
        raise ValueError("reference.mean_flux = 0: no relative error of the flux follows")
    points, weights, values = _compared(field, points, mask, "flux")
    return _error(np.linalg.norm(values - reference.flux_at(points), axis=1) / scale, weights, points)


def heat_balance(field):
    """Sum of the heat that enters through the walls over the largest of them; 0 in a perfect steady balance.

    Raises
    ------
    ValueError
        In a periodic cell, where heat crosses no wall.
    """
    if field.scene.periodic:
        raise ValueError("field.scene is periodic: no heat enters through walls, there is no balance to check")
    heats = np.array(list(field.wall_heat.values()))
    largest = np.abs(heats).max(initial=0.0)
    return float(heats.sum() / largest) if largest > 0 else 0.0


def bound_violation(field, lower, upper):
    """How far the effective conductivity lies outside bounds, relative to the bound passed; 0 between them.

    Parameters
    ----------
    field : Field
    lower, upper : float, W/(m K)
        Worked out with `field.fractions`, the method's own: with others a correct method may look wrong.

    Returns
    -------
    float
        Negative below the lower bound, positive above the upper one.
    """
    if not 0 <= lower <= upper:
        raise ValueError(f"lower = {lower!r}, upper = {upper!r}: must be 0 <= lower <= upper")
    k = field.conductivity
    if k < lower:
        return k / lower - 1.0
    if k > upper:
        return k / upper - 1.0 if upper > 0 else float("inf")
    return 0.0


def _compared(field, points, mask, name):
    """Points, weights and the field's values there."""
    if points is None:
        samples = field.samples
        points, weights, values = samples.points, samples.volumes, getattr(samples, name)
    else:
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        weights, values = np.ones(len(points)), None
    keep = mask(points) if callable(mask) else mask
    if keep is not None:
        keep = np.asarray(keep)
        if keep.dtype != bool or keep.shape != (len(points),):
            raise ValueError(f"mask of shape {keep.shape}, {keep.dtype}: must be {len(points)} booleans")
        points, weights, values = points[keep], weights[keep], values if values is None else values[keep]
    if not len(points):
        raise ValueError("points: none left to compare")
    return points, weights, getattr(field, name + "_at")(points) if values is None else values


def _error(values, weights, points):
    """Error from magnitudes; a value that is not finite makes both rms and maximum not finite."""
    worst = int(np.argmax(values))  # that of the first NaN if there is one
    return Error(float(np.sqrt(np.average(values**2, weights=weights))), float(values[worst]), points[worst])
