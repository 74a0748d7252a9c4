"""Conductivities and fields of cubic arrays to the digits printed, and by the equations: all methods stand on them."""

import functools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from references.exact import harmonics, lattice, lattice_field

THIRD = 4 * math.pi / 81
KINDS = ("sc", "bcc", "fcc")


def sphere_points(count, seed):
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    return normals / np.linalg.norm(normals, axis=1)[:, None]


@pytest.mark.parametrize(
    ("contrast", "fraction", "printed", "digits", "order"),
    [
        (0.01, THIRD, 0.786847280, 9, None),
        (10, THIRD, 1.395734838, 9, None),
        (1e6, THIRD, 1.552615028, 9, None),
        (10, 0.5, 3.1445580197, 10, 79),
    ],
)
def test_printed_conductivities(contrast, fraction, printed, digits, order):
    found = lattice.solve("sc", contrast, fraction, order=order)
    # Half a unit of the last digit printed.
    assert_allclose(found.conductivity, printed, atol=0.5 * 10.0**-digits, rtol=0)
    assert found.digits >= 9
    assert found.residual < 1e-13


# Zuzovsky and Brenner, J. Appl. Math. Phys. 28 (1977) 979: the coefficient of phi^(10/3).
@pytest.mark.parametrize(("kind", "coefficient"), [("sc", 1.305), ("bcc", 0.129), ("fcc", 0.0753)])
@pytest.mark.parametrize("contrast", [0.0, 3.0, math.inf])
def test_dilute_limit_is_the_published_series(kind, coefficient, contrast):
    inverse = 1.0 if math.isinf(contrast) else (contrast + 2) / (contrast - 1)
    octupole = 1.0 if math.isinf(contrast) else (contrast - 1) / (contrast + 4 / 3)
    found = []
    for f in (0.01, 0.02):
        k = lattice.conductivity(kind, contrast, f)
        found.append((inverse - f - 3 * f / (k - 1)) / (f ** (10 / 3) * octupole))
    limit = found[0] - (found[1] - found[0]) / (2 ** (4 / 3) - 1)
    # The next terms are smaller by f^(4/3), taken off, and f^(7/3) = 1e-4; half a unit of the last printed digit.
    assert_allclose(limit, coefficient, rtol=1e-4, atol=5e-5 if kind == "fcc" else 5e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_limits_are_approached(kind):
    f = 0.2
    # The distance to a limit is of the order of the contrast (or its inverse) itself.
    assert_allclose(lattice.conductivity(kind, 1e-9, f), lattice.conductivity(kind, 0, f), rtol=1e-8)
    assert_allclose(lattice.conductivity(kind, 1e9, f), lattice.conductivity(kind, math.inf, f), rtol=1e-8)
    assert lattice.conductivity(kind, 1, f) == 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_zeta2_is_the_third_order_of_the_conductivity(kind):
    f, found = 0.3, []
    for beta in (0.01, -0.01):
        k = lattice.conductivity(kind, (1 + 2 * beta) / (1 - beta), f)
        found.append((1 - f * beta - 3 * f * beta / (k - 1)) / (2 * (1 - f) * beta**2))
    # Even remainder of order beta^2 = 1e-4 of zeta_2 itself; rounding 1e-16 / beta^3 = 1e-10.
    assert_allclose(np.mean(found), lattice.zeta2(kind, f), rtol=1e-3)


CASES = [("sc", 0.3, 5.0), ("sc", THIRD, 0.0), ("bcc", 0.3, 0.1), ("fcc", 0.4, math.inf)]
solved = functools.cache(lattice.solve)
GRADIENT = np.array([0.3, -0.5, 0.8])


@pytest.mark.parametrize(("kind", "fraction", "contrast"), CASES)
def test_interface_conditions(kind, fraction, contrast):
    array = solved(kind, contrast, fraction)
    normals = sphere_points(60, seed=1)
    inside, outside = normals * array.radius * (1 - 1e-13), normals * array.radius * (1 + 1e-13)
    # The series is cut where the flux at the interface has 10 digits; fluxes there are of order 1 to 10.
    jump = lattice_field.flux(array, outside, GRADIENT) - lattice_field.flux(array, inside, GRADIENT)
    assert_allclose(np.sum(jump * normals, axis=1), 0, atol=1e-9)
    warm = [lattice_field.temperature(array, points, GRADIENT) for points in (inside, outside)]
    assert_allclose(warm[0], warm[1], atol=1e-10)


@pytest.mark.parametrize(("kind", "fraction", "contrast"), CASES)
def test_flux_is_the_slope_of_temperature(kind, fraction, contrast):
    array, h = solved(kind, contrast, fraction), 1e-4
    points = np.random.default_rng(2).uniform(-0.7, 0.7, size=(40, 3))
    away = np.linalg.norm(points - lattice_field.nearest_site(kind, points), axis=1) - array.radius
    points, conductivity = points[abs(away) > 4 * h], np.where(away > 0, 1.0, contrast)[abs(away) > 4 * h]
    if contrast == math.inf:  # No slope inside, yet a flux.
        points, conductivity = points[conductivity == 1], conductivity[conductivity == 1]
    slope = np.empty_like(points)
    for axis, step in enumerate(h * np.eye(3)):
        at = [lattice_field.temperature(array, points + s * step, GRADIENT) for s in (-2, -1, 1, 2)]
        slope[:, axis] = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)
    # Fourth order differences: rounding 1e-15 / h and truncation some 1e3 h^4.
    flux = lattice_field.flux(array, points, GRADIENT)
    assert_allclose(flux, -conductivity[:, None] * slope, atol=1e-9)


@pytest.mark.parametrize(("kind", "fraction", "contrast"), CASES)
def test_field_is_continuous_and_periodic(kind, fraction, contrast):
    array = solved(kind, contrast, fraction)
    points = np.random.default_rng(3).uniform(-0.5, 0.5, size=(60, 3))
    here = lattice_field.temperature(array, points, GRADIENT)
    for shift in ([1, 0, 0], [0, -2, 1], np.array(harmonics.SITES[kind][-1])):
        there = lattice_field.temperature(array, points + shift, GRADIENT)
        assert_allclose(there - here, GRADIENT @ shift, atol=1e-12)  # rounding of coordinates
    # Across a plane between cells the two sides are summed from different sites.
    points[:, 0] = 0.5
    step = np.array([1e-13, 0, 0])
    below, above = (lattice_field.flux(array, points + s * step, GRADIENT) for s in (-1, 1))
    keep = np.linalg.norm(points - lattice_field.nearest_site(kind, points), axis=1) > array.radius + 1e-9
    # Cut series: 10 digits of a flux of order 1 to 10.
    assert_allclose(below[keep], above[keep], atol=1e-9)


@pytest.mark.parametrize(("kind", "plane"), [("sc", 0.5), ("bcc", 0.25), ("fcc", 0.25)])
def test_mean_flux_by_quadrature_over_a_plane(kind, plane):
    array = lattice.solve(kind, 20.0, 0.05)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    x, y = np.meshgrid(nodes / 2, nodes / 2)
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, plane)], axis=1)
    mean = -np.outer(weights, weights).ravel() / 4 @ lattice_field.flux(array, points, (0, 0, 1))
    # Gauss's rule converges geometrically here: 1e-10 at 24 nodes.
    assert_allclose(mean, [0, 0, array.conductivity], atol=1e-9)


@pytest.mark.parametrize(("fraction", "contrast"), [(0.5235, 100.0), (0.5235, 0.0), (0.52, math.inf)])
def test_digits_are_honest_when_spheres_nearly_touch(fraction, contrast):
    rough = lattice.solve("sc", contrast, fraction, order=29, digits=0)
    better = lattice.solve("sc", contrast, fraction, order=59, digits=0)
    assert abs(rough.conductivity / better.conductivity - 1) <= 10.0**-rough.digits
    assert rough.digits < better.digits < lattice.MOST_DIGITS
