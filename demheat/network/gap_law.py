"""What a medium between two bodies conducts where they nearly touch, or around their contact, in closed form."""

import numpy as np
from scipy.special import xlogy, zeta

# How lines of flow draw together below a point contact, and beside a wide contact.
POINT, RIM = 2.0 * float(np.exp(np.euler_gamma)), float(np.expm1(7.0 * zeta(3.0) / np.pi**2))
# The closed form is a ratio of differences where its two roots meet: they are held so far apart, as a part of the
# larger one. That changes p, and so the conductance, by a quarter of the square, 3e-11; rounding leaves 1e-11.
APART = 1e-5


def gap_conductance(width, contact, disc, curvature, resistivity, medium):
    """Conductance of the ring of medium around a contact, or between two near bodies; see `demheat.grains.laws`.

    Radii of the contact, of the disc and of 1/R = 1/R_1 + 1/R_2; 1/k_1 + 1/k_2; the medium's conductivity.
    """
    inner, outer, s = np.asarray(contact, dtype=float), np.maximum(disc, contact), 0.5 / (curvature * medium)
    p = np.where(inner > 0, 0.0, np.maximum(width, 0.0)) / medium
    q = POINT * resistivity + s * RIM * inner
    square = q**2 - 4.0 * p * s
    least = (APART * q) ** 2
    square = np.where(np.abs(square) < least, np.where(square < 0, -least, least), square)
    # Roots below zero are a complex pair: the same form, whose imaginary parts cancel.
    u = (q + np.sqrt(square.astype(complex))) / (2.0 * s)
    v = np.where(square > 0, p / (s * u), np.conj(u))
    # Of a point contact v ln v is 0.
    parts = [root * np.log(outer + root) - xlogy(root, inner + root) for root in (u, v)]
    return np.real(2.0 * np.pi / s * (parts[0] - parts[1]) / (u - v))
