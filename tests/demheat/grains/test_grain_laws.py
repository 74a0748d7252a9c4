"""Only here: the closed form of a gap off its integral, or off the limits that are known."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.special import j1, k0

from demheat.grains import Fixed, Hertz, Overlap, laws


def by_quadrature(width, contact, disc, curvature, resistivity, medium):
    s = 0.5 / (curvature * medium)
    p, q = 0.0 if contact else width / medium, laws.POINT * resistivity + s * laws.RIM * contact
    # By the logarithm of the radius, below which nothing is left to rounding.
    low = max(contact, 1e-20 * disc)
    value = quad(
        lambda t: 2 * np.pi * np.exp(2 * t) / (p + q * np.exp(t) + s * np.exp(2 * t)),
        np.log(low),
        np.log(disc),
        epsabs=0,
        epsrel=1e-12,
        limit=500,
    )
    return value[0]


def conductance(width, contact, disc, curvature, resistivity, medium=1.0):
    arrays = (np.atleast_1d(np.asarray(each, dtype=float)) for each in (width, contact, disc, curvature, resistivity))
    return laws.gap_conductance(*arrays, medium)[0]


@pytest.mark.parametrize("seed", range(8))
def test_the_closed_form_is_the_integral(seed):
    rng = np.random.default_rng(seed)
    contact = (0.0, 10 ** rng.uniform(-4, -0.5))[seed % 2]
    width = (10 ** rng.uniform(-8, 0), 0.0)[seed % 4 == 2]
    curvature, resistivity = 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-6, 2)
    given = width, contact, 0.5, curvature, resistivity, 0.026
    # Rounding of both, and what keeps roots apart.
    assert_allclose(conductance(*given), by_quadrature(*given), rtol=1e-10)


@pytest.mark.parametrize("off", [0.0, -1e-12, 1e-5])
def test_where_the_roots_meet(off):
    resistivity, curvature = 0.02, 0.5
    width = (laws.POINT * resistivity) ** 2 / 4 * 2 * curvature * (1 + off)
    given = width, 0.0, 0.5, curvature, resistivity, 1.0
    # A quarter of the square of what keeps them apart, and the rounding over it.
    assert_allclose(conductance(*given), by_quadrature(*given), rtol=1e-10)


def test_perfect_conductors():
    # The grains' own resistance is 1e-12 of the gap's.
    for width in (1e-3, 0.1, 1.0):
        expected = 2 * np.pi * 3.0 * 0.5 * np.log1p(0.25 / (2 * 0.5 * width))
        assert_allclose(conductance(width, 0.0, 0.5, 0.5, 1e-15, 3.0), expected, rtol=1e-9)


def test_wide_gaps_are_slabs():
    # Of curvature and the grains 1e-6 is left.
    assert_allclose(conductance(1e3, 0.0, 0.5, 1e3, 1e-6), np.pi * 0.25 / 1e3, rtol=1e-5)


def test_a_point_contact_is_that_of_the_near_field():
    """Heat within X of the contact: the transform of 2 K_0(2 sqrt(.)) solves the problem of two near half-spaces.

    In units of 2 R k_f (1/k_1 + 1/k_2) it tends to ln X - gamma - ln 2, the ring's form to ln X - ln POINT.
    """
    X = 400.0

    def between(low, high):
        return quad(lambda y: 2 * k0(2 * np.sqrt(y / X)) * j1(y), low, high, epsabs=1e-12, limit=200)[0]

    edges = np.linspace(0, 20_000, 4001)
    pieces = np.cumsum([between(*each) for each in zip(edges[:-1], edges[1:], strict=True)])
    # Partial sums go to and fro around the limit, less and less: what remains at the end is 1e-6.
    exact = pieces[-400:].mean()
    # Beyond the leading logarithm it is ln(X) / X.
    assert_allclose(np.log(X) - np.log(laws.POINT), exact, atol=3 * np.log(X) / X)
    assert abs(exact - (np.log(X) - np.log(np.pi / 2))) > 0.5


def test_the_rim_of_a_wide_contact():
    """Energy in the gap beside a disc: (2/pi arccos(a/r))^2 over the gap (r^2 - a^2)/(2 R), to first order in k_f."""

    def rising(t):
        return 2 * ((2 * t / np.pi) ** 2 / (np.sin(t) * np.cos(t)) - np.tan(t))

    lost = quad(rising, 0, np.pi / 2, epsabs=1e-12, limit=500)[0]
    contact, disc, curvature = 1e-6, 1.0, 0.5
    exact = 2 * np.pi * curvature * (np.log((disc / contact) ** 2) + lost)
    # The disc is 1e6 contacts wide, the grains conduct 1e15 times better.
    assert_allclose(conductance(0.0, contact, disc, curvature, 1e-15), exact, rtol=1e-6)


def test_contacts_in_series_with_half_spaces():
    # 4 a k of each half-space.
    series = 1 / (1 / (4 * 0.1 * 2.0) + 1 / (4 * 0.1 * 5.0))
    assert_allclose(laws.contact_conductance(0.1, laws.resistivity(2.0, 5.0)), series, rtol=1e-14)
    assert_allclose(laws.contact_conductance(0.1, laws.resistivity(3.0, 3.0)), 2 * 3.0 * 0.1, rtol=1e-14)


def test_a_wall_is_a_mirror():
    for width, contact in ((0.02, 0.0), (0.0, 0.05)):
        pair = conductance(2 * width, contact, 0.5, 0.5, 2 / 7.0)
        assert_allclose(conductance(width, contact, 0.5, 1.0, 1 / 7.0), 2 * pair, rtol=1e-12)


def test_contact_radii():
    one, other, apart = np.array([1.0]), np.array([0.5]), np.array([1.45])
    assert_allclose(Overlap().radius(apart, one, other), np.sqrt(1 - ((1.45**2 + 1 - 0.25) / 2.9) ** 2))
    # A parabola for small overlaps.
    assert_allclose(Overlap().radius(1.5 - 1e-6, one, other) ** 2, 2 / 3 * 1e-6, rtol=1e-5)
    assert_allclose(Hertz().radius(apart, one, other) ** 2, 0.05 / 3)
    assert_allclose(Overlap().wall_radius(np.array([0.8]), one), 0.6)
    assert_allclose(Hertz().wall_radius(np.array([0.8]), one) ** 2, 0.2)
    for law in (Overlap(), Hertz(), Fixed(ratio=0.1)):
        assert law.radius(np.array([1.5001]), one, other) == 0 and law.wall_radius(np.array([1.001]), one) == 0
    assert_allclose(Fixed(ratio=0.1).radius(np.array([1.5]), one, other), 0.05)


def test_hertz_by_force_and_by_overlap_are_one():
    law, radii = Hertz(young=2e11, poisson=0.28), (np.array([2e-3]), np.array([1e-3]))
    overlap, modulus = 1e-7, 2e11 / 2 / (1 - 0.28**2)
    force = 4 / 3 * modulus * np.sqrt(laws.reduced(*radii)) * overlap**1.5
    assert_allclose(law.pressed(force, *radii), law.radius(3e-3 - overlap, *radii), rtol=1e-9)
    assert law.pressed(np.array([-1.0]), *radii) == 0
    with pytest.raises(ValueError, match="Hertz.young = None: contact radii by forces need a modulus"):
        Hertz().pressed(force, *radii)
