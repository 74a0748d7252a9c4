"""Ellipsoids apart from each other: depolarisation factors, polarisabilities, and Maxwell's tensor of many.

Source: Landau and Lifshitz, Electrodynamics of Continuous Media, sections 4 and 8; Milton, The Theory of Composites
(2002), sections 7.8 and 10.1. In a uniform field the field inside an ellipsoid is uniform: along its axis i it is
1/(1 + L_i (s - 1)) of the one around it, s the contrast, so that its dipole per volume is (s - 1)/(1 + L_i (s - 1)).
Conductivities are in units of the matrix; the axes of a `frame` are those of the ellipsoid, its rows in the scene.
"""

import math

import numpy as np
from scipy.special import elliprd

# Rounding of the rows of a frame that users work out.
SQUARE = 1e-9


def depolarisation(axes) -> np.ndarray:
    """Depolarisation factors L_i of an ellipsoid, (3,) float array; their sum is 1.

    Parameters
    ----------
    axes : (3,) sequence of float
        Half axes, in any unit.

    Raises
    ------
    ValueError
        If an axis is not a finite number > 0.

    Notes
    -----
    L_i = abc/2 times the integral over t from 0 of 1/((t + a_i^2) sqrt((t + a^2)(t + b^2)(t + c^2))): Carlson's R_D.

    Examples
    --------
    >>> from references.exact.ellipsoids import depolarisation
    >>> depolarisation((2.0, 1.0, 1.0)).round(6).tolist()
    [0.173564, 0.413218, 0.413218]
    """
    axes = _checked_axes(axes)
    a, b, c = (axes / axes.max()) ** 2
    own = np.array([elliprd(b, c, a), elliprd(a, c, b), elliprd(a, b, c)])
    return math.sqrt(a * b * c) / 3 * own


def polarisability(contrast, axes, *, frame=None) -> np.ndarray:
    """Dipole of an ellipsoid per volume for a unit gradient far away, a (3, 3) float array.

    Parameters
    ----------
    contrast : float
        Conductivity of the ellipsoid over that of the matrix, 0 (pore) to infinity (inclusive).
    axes : (3,) sequence of float
        Half axes, in any unit.
    frame : (3, 3) float array, optional
        Unit vectors along the axes, one a row; by default x, y, z.

    Raises
    ------
    ValueError
        If an argument is not as described.

    Examples
    --------
    >>> from references.exact.ellipsoids import polarisability
    >>> polarisability(10.0, (2.0, 1.0, 1.0)).diagonal().round(4).tolist()
    [3.5128, 1.9072, 1.9072]
    """
    shape, turn = depolarisation(axes), _checked_frame(frame)
    return turn.T @ np.diag(_along_axes(contrast, shape)) @ turn


def dilute(contrast, axes, fraction, *, frame=None) -> np.ndarray:
    """Conductivity of few equal, parallel ellipsoids over that of the matrix: exact to first order in their fraction.

    Parameters
    ----------
    contrast, axes, frame
        As those of `polarisability`.
    fraction : float
        Their volume fraction.

    Returns
    -------
    (3, 3) float array

    Examples
    --------
    >>> from references.exact.ellipsoids import dilute
    >>> dilute(10.0, (2.0, 1.0, 1.0), 0.01).diagonal().round(5).tolist()
    [1.03513, 1.01907, 1.01907]
    """
    _check_fraction(fraction)
    return np.eye(3) + fraction * polarisability(contrast, axes, frame=frame)


def maxwell(contrast, axes, fraction, *, envelope=(1.0, 1.0, 1.0), frame=None) -> np.ndarray:
    """Maxwell's estimate: so many parallel ellipsoids in an envelope act as one homogeneous ellipsoid in its place.

    Parameters
    ----------
    contrast, axes, frame
        As those of `polarisability`.
    fraction : float
        Volume fraction of the ellipsoids.
    envelope : (3,) sequence of float
        Half axes of the envelope, along those of the ellipsoids: a sphere where they are spread alike along all
        directions.

    Returns
    -------
    (3, 3) float array
        Over the conductivity of the matrix; exact to first order in the fraction.

    Raises
    ------
    ValueError
        If an argument is not as described, or the envelope is so unlike the ellipsoids that the estimate has no sense.

    Examples
    --------
    >>> from references.exact.ellipsoids import maxwell
    >>> maxwell(10.0, (2.0, 1.0, 1.0), 0.1).diagonal().round(5).tolist()
    [1.39786, 1.20367, 1.20367]
    """
    _check_fraction(fraction)
    along, turn = _along_axes(contrast, depolarisation(axes)), _checked_frame(frame)
    against = 1 - fraction * depolarisation(envelope) * along
    if np.any(against <= 0):
        raise ValueError(
            f"fraction = {fraction!r}: too many ellipsoids of axes {tuple(axes)} for an envelope {tuple(envelope)}; "
            "must be fewer, or the envelope nearer to their shape"
        )
    return turn.T @ np.diag(1 + fraction * along / against) @ turn


def penny_cracks(density) -> float:
    """Conductivity across few insulated parallel discs over that of the matrix, 1 - 8/3 density: exact to first order.

    The limit of flat pores: of half axes a, a, c it is 4/3 pi a^2 c / (1 - L_c), and 1 - L_c is pi c / (2 a) at last.

    Parameters
    ----------
    density : float
        Number of discs per volume times the cube of their radius.

    Raises
    ------
    ValueError
        If the density is not from 0 to 3/8.

    Examples
    --------
    >>> from references.exact.ellipsoids import penny_cracks
    >>> print(f"{penny_cracks(0.03):.2f}")
    0.92
    """
    if not 0 <= density <= 3 / 8:
        raise ValueError(f"density = {density!r}: must be from 0 to 3/8, discs per volume times their cubed radius")
    return 1 - 8 / 3 * density


def _along_axes(contrast, shape):
    if not contrast >= 0:
        raise ValueError(f"contrast = {contrast!r}: must be a number >= 0, infinity included")
    return 1 / shape if math.isinf(contrast) else (contrast - 1) / (1 + shape * (contrast - 1))


def _checked_axes(axes):
    found = np.asarray(axes, dtype=float)
    if found.shape != (3,) or not np.all((found > 0) & np.isfinite(found)):
        raise ValueError(f"axes = {axes!r}: must be three finite numbers > 0")
    return found


def _checked_frame(frame):
    found = np.eye(3) if frame is None else np.asarray(frame, dtype=float)
    if found.shape != (3, 3) or not np.allclose(found @ found.T, np.eye(3), rtol=0, atol=SQUARE):
        raise ValueError(f"frame = {frame!r}: must be three rows of length 1 at right angles")
    return found


def _check_fraction(fraction):
    if not 0 <= fraction < 1:
        raise ValueError(f"fraction = {fraction!r}: must be >= 0 and < 1")
