"""Responses of a slab to one of its faces in time: a series of images for short times, of modes for long ones.

Source: Carslaw and Jaeger, Conduction of Heat in Solids (1959), sections 2.4-2.5 and 3.3-3.8 for the slab, 9.3 for the
sphere. A face is driven by a unit step of its temperature, a unit step of the heat flux into it, or a temperature that
rises at unit rate. With z = (distance travelled) / (2 sqrt(a t)) its wave is i^n erfc z, n = 0, 1, 2. A reflection at a
face of known temperature turns its sign, one at a face of known flux does not.
"""

import math

import numpy as np
from scipy.special import erfc, spherical_jn

# Fourier number a t / L^2 from which modes are summed. Either series is exact to rounding on both sides of it.
CROSSOVER = 0.01
# exp(-REST) and erfc(sqrt(REST)) are less than 1e-17: what is left out is less than rounding.
REST = 39.0
ORDERS = {"temperature": 0, "flux": 1, "ramp": 2}


def response(x, fourier, drive, far, *, method="auto"):
    """Response of a slab of unit length, diffusivity and conductivity, at rest at 0, to its face at 0."""
    x = np.asarray(x, dtype=float)
    if method == "auto":
        method = "modes" if fourier >= CROSSOVER else "images"
    if method == "modes":
        steady, decaying = _steady(x, fourier, drive, far), _modes(x, fourier, drive, far)
        return steady[0] + decaying[0], steady[1] + decaying[1]
    return _images(x, fourier, drive, far)


def _images(x, fourier, drive, far):
    order, width = ORDERS[drive], 2.0 * math.sqrt(fourier)
    near_sign = 1.0 if drive == "flux" else -1.0
    far_sign = -1.0 if far == "held" else 1.0
    value, slope, sign = np.zeros_like(x), np.zeros_like(x), 1.0
    for turn in range(1 + math.ceil(math.sqrt(REST) * width / 2)):
        for travelled, along, weight in ((2 * turn + x, 1.0, sign), (2 * turn + 2 - x, -1.0, sign * far_sign)):
            z = travelled / width
            value += weight * width**order * _repeated_erfc(order, z)
            slope -= weight * along * width ** (order - 1) * _repeated_erfc(order - 1, z)
        sign *= near_sign * far_sign
    return value, slope


def _repeated_erfc(order, z):
    """Repeated integrals i^n erfc z of the complementary error function, from -1 to 2; rounding is absolute."""
    gauss = 2.0 / math.sqrt(math.pi) * np.exp(-(z**2))
    if order == -1:
        return gauss
    if order == 0:
        return erfc(z)
    first = 0.5 * gauss - z * erfc(z)
    return first if order == 1 else 0.25 * (erfc(z) - 2.0 * z * first)


def _steady(x, fourier, drive, far):
    """What is left when the modes have died out, and its slope."""
    one = np.ones_like(x)
    if drive == "temperature":
        return (1.0 - x, -one) if far == "held" else (one, 0.0 * x)
    if drive == "flux":
        if far == "held":
            return 1.0 - x, -one
        return fourier + 0.5 * (1.0 - x) ** 2 - 1.0 / 6.0, x - 1.0
    if far == "held":
        lag, slope = x * (1.0 - x) * (2.0 - x) / 6.0, (2.0 - 6.0 * x + 3.0 * x**2) / 6.0
        return fourier * (1.0 - x) - lag, -fourier - slope
    return fourier - x + 0.5 * x**2, x - 1.0


def _modes(x, fourier, drive, far):
    """Sum over modes that decay as exp(-m^2 t), and its slope."""
    count = 2 + math.ceil(math.sqrt(REST / fourier) / math.pi)
    # Modes are sines of m x for a driven temperature, cosines for a driven flux.
    whole = (drive == "flux") == (far == "insulated")
    m = np.pi * (np.arange(1, count + 1) - (0.0 if whole else 0.5))
    weight = {"temperature": -2.0 / m, "flux": -2.0 / m**2, "ramp": 2.0 / m**3}[drive] * np.exp(-(m**2) * fourier)
    value, slope = np.zeros_like(x), np.zeros_like(x)
    for k, w in zip(m, weight, strict=True):
        sine, cosine = np.sin(k * x), np.cos(k * x)
        value += w * (cosine if drive == "flux" else sine)
        slope += w * k * (-sine if drive == "flux" else cosine)
    return value, slope


def sphere_response(r, fourier, drive, *, method="auto"):
    """Response of a sphere of unit radius, diffusivity and conductivity, at rest at 0, to its surface.

    r times the temperature obeys the equation of a slab, held at 0 in the centre and driven at the surface.
    """
    r = np.asarray(r, dtype=float)
    if method == "auto":
        method = "modes" if fourier >= CROSSOVER else "images"
    if method == "modes":
        return _sphere_modes(r, fourier, drive)
    # Nearer to the centre the temperature differs by less than rounding. The division by r^2 costs digits, but before
    # `CROSSOVER` what has come so far is less than 1e-9.
    r = np.maximum(r, 1e-6)
    value, slope = _images(1.0 - r, fourier, drive, "held")
    return value / r, -slope / r - value / r**2


def _sphere_modes(r, fourier, drive):
    """Modes sin(m r) / r without the division: right in the centre."""
    value, slope = (np.ones_like(r), 0.0 * r) if drive == "temperature" else (fourier - (1 - r**2) / 6, r / 3)
    for n in range(1, 3 + math.ceil(math.sqrt(REST / fourier) / math.pi)):
        m = n * math.pi
        weight = (2.0 / m if drive == "temperature" else -2.0 / m**3) * (-1) ** n * math.exp(-(m**2) * fourier)
        value += weight * m * spherical_jn(0, m * r)
        slope -= weight * m**2 * spherical_jn(1, m * r)
    return value, slope
