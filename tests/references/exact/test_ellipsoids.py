"""Ellipsoids apart: factors by another integral and in limits; no method is held against them elsewhere."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.bounds import maxwell as of_spheres
from references.exact import ellipsoids
from references.exact.inclined import laminate


def by_directions(axes):
    """The field in the middle of a body of uniform polarisation: a mean over all directions u from there.

    That of the charge on its surface: u_i n_i / (u n), n the normal, along u_i / a_i^2 on an ellipsoid.
    """
    nodes, weights = np.polynomial.legendre.leggauss(400)
    turn = 2 * math.pi * (np.arange(400) + 0.5) / 400
    across = np.sqrt(1 - nodes**2)[:, None]
    u = np.stack([across * np.cos(turn), across * np.sin(turn), nodes[:, None] + 0 * turn])
    part = u**2 / (np.array(axes) ** 2)[:, None, None]
    return np.einsum("ikl,k->i", part / part.sum(axis=0), weights) / (2 * len(turn))


@pytest.mark.parametrize("axes", [(1.0, 1.0, 1.0), (3.0, 2.0, 1.0), (1e-3, 5e-3, 2e-3)])
def test_factors_by_another_integral(axes):
    found = ellipsoids.depolarisation(axes)
    # Both rules converge geometrically on functions as smooth as these.
    assert_allclose(found, by_directions(axes), rtol=1e-12)
    assert_allclose(found.sum(), 1.0, rtol=1e-14)


def test_factors_of_spheroids():
    """Landau and Lifshitz, section 4: closed forms of prolate and oblate ones."""
    e = math.sqrt(1 - 0.25)
    assert_allclose(ellipsoids.depolarisation((1, 1, 2))[2], 0.25 / e**3 * (math.atanh(e) - e), rtol=1e-13)
    e = math.sqrt(4 - 1)
    assert_allclose(ellipsoids.depolarisation((2, 2, 1))[2], 4 / e**3 * (e - math.atan(e)), rtol=1e-13)


def test_spheres_are_maxwells():
    for s in (0.0, 0.3, 8.0):
        found = ellipsoids.maxwell(s, (2.0, 2.0, 2.0), 0.3)
        assert_allclose(found, of_spheres(1.0, s, 0.3) * np.eye(3), atol=1e-14)
    # beta = 1: 1 + 3 f / (1 - f).
    assert_allclose(ellipsoids.maxwell(math.inf, (1, 1, 1), 0.3)[0, 0], 1 + 0.9 / 0.7, rtol=1e-14)


def test_plates_and_needles_are_layers_and_fibres():
    plate, needle = (1.0, 1.0, 1e-9), (1.0, 1.0, 1e7)
    for s in (0.2, 7.0):
        found = ellipsoids.maxwell(s, plate, 0.3, envelope=plate)
        # A factor is off by the flatness, times the contrast.
        assert_allclose(found, laminate([1.0, s], [0.7, 0.3], (0, 0, 1)), atol=1e-7)
        assert_allclose(ellipsoids.maxwell(s, needle, 0.3, envelope=needle)[2, 2], 0.7 + 0.3 * s, rtol=1e-9)


def test_turned_frames():
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    straight = ellipsoids.polarisability(5.0, (3.0, 2.0, 1.0))
    turned = ellipsoids.polarisability(5.0, (3.0, 2.0, 1.0), frame=turn)
    for row, own in zip(turn, np.diag(straight), strict=True):
        assert_allclose(turned @ row, own * row, atol=1e-14)
    assert_allclose(ellipsoids.dilute(5.0, (3.0, 2.0, 1.0), 0.1, frame=turn), np.eye(3) + 0.1 * turned)
    # To first order all estimates agree; the next is of the square of the fraction, times some 10.
    tiny = ellipsoids.maxwell(5.0, (3.0, 2.0, 1.0), 1e-5, frame=turn) - np.eye(3)
    assert_allclose(tiny, 1e-5 * turned, atol=1e-9)


def test_flat_pores_are_cracks():
    """Pores of half axes a, a, c: what their number takes away tends to discs'; next is 4/pi c/a of it."""
    for flat in (1e-3, 1e-5):
        alpha = ellipsoids.polarisability(0.0, (1.0, 1.0, flat))
        density, volume = 1e-3, 4 / 3 * math.pi * flat
        assert_allclose(1 + density * volume * alpha[2, 2], ellipsoids.penny_cracks(density), atol=4 * flat * density)
        # Along the discs nothing is lost but their volume.
        assert_allclose(alpha[0, 0], -1.0, atol=2 * flat)
