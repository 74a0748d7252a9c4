"""Spheres that nearly touch, or do: pairs by all degrees among the few of the whole."""

import math
from functools import cache, partial

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat import Material, Scene, Sphere
from references import multipole
from references.exact import lattice
from references.multipole import contacts, truncation
from references.multipole.arrangement import arrange
from references.multipole.nearest_images import beside
from references.multipole.sums import entries, harmonics
from references.multipole.system import homogeneous, solve_order
from references.multipole.turns import turned
from references.multipole.two_spheres import Two, direct, exchanged, polarisability

# Of what a sum over degrees is as an integral, from 1024 on.
SUMS = 1e-8


def carried_on(scene, accuracy=1e-5):
    """The mean flux where pairs are solved by all degrees though plain orders would do, and the error that is said."""
    arrangement = arrange(scene)
    plain = [homogeneous(arrangement.spheres, arrangement.gradient)]
    wanted = {"accuracy": accuracy, "tolerance": 1e-10, "threads": 1, "kept": {}}
    rest = partial(truncation.by_images, near=beside(arrangement.spheres))
    history = truncation._in_contact(arrangement, plain, rest, **wanted)
    assert history[-1].pairs > 0
    return history[-1].mean_flux / arrangement.unit, rest(history).left


def in_order(gap, contrast):
    """Spheres in cubic order, the gap over their radius."""
    radius = 1 / (2 + gap)
    return Scene((1,) * 3, Material(1.0), [Sphere((0.5,) * 3, radius, Material(contrast))], gradient=(0, 0, 1))


def test_pairs_of_unlike_radii_are_known_more_slowly():
    """What comes to a small sphere beside a large one is known by degrees about that one's centre, not far from it."""
    large, small, gap = 0.35, 0.043, 0.0055
    ways = 0.5 + (large + small + gap) / math.sqrt(3) * (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1)
    spheres = [Sphere((0.5,) * 3, large, Material(math.inf)), *(Sphere(way, small, Material(1e4)) for way in ways)]
    scene = Scene((1,) * 3, Material(1.0), spheres, gradient=(0, 0, 1))
    arrangement = arrange(scene)
    # By 64 degrees, in half a minute.
    history, flux, right = [homogeneous(arrangement.spheres, arrangement.gradient)], {}, -1.179339707
    for order in (16, 24, 32):
        table = contacts.Contacts(arrangement.spheres, order, 1e-8)
        options = {"tolerance": 1e-8, "received": table.received}
        found = solve_order(arrangement.spheres, table, arrangement.gradient, order, **options)
        history.append(found._replace(pairs=len(table.pairs.here)))
        flux[order] = found.mean_flux[2]
    near = beside(arrangement.spheres)
    for last, order in ((3, 24), (4, 32)):
        off = abs(flux[order] / right - 1)
        assert off < truncation.by_images(history[:last], near).left < 4 * off


def test_turns_bring_a_direction_to_z_and_back():
    n, m = entries(7)
    rng = np.random.default_rng(0)
    tables = rng.normal(size=(4, len(n))) + 1j * rng.normal(size=(4, len(n)))
    tables[:, m == 0] = tables[:, m == 0].real
    ways = rng.normal(size=(4, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    angles = np.stack([np.arctan2(np.hypot(*ways.T[:2]), ways[:, 2]), np.arctan2(ways[:, 1], ways[:, 0])], axis=1)
    found = turned(tables, angles)
    assert_allclose(turned(found, angles, back=True), tables, rtol=0, atol=1e-13)

    def value(table, point):
        return np.sum(np.where(m == 0, 1, 2) * (table * harmonics(point[None], 7)[0]).real)

    values = [value(table, way) for table, way in zip(tables, ways, strict=True)]
    assert_allclose([value(table, np.array([0.0, 0, 1])) for table in found], values, rtol=1e-12)


@pytest.mark.parametrize("m", [0, 1, 3])
@pytest.mark.parametrize(
    "two",
    [Two(2.02, (1.0, 1.0), (1e4, math.inf), (0.0, 0.1)), Two(1.31, (1.0, 0.3), (0.0, 50.0), (0.0, 0.0))],
    ids=["alike", "unlike"],
)
def test_two_spheres_answer_each_other_by_all_degrees(two, m):
    """Beside 300 degrees one by one."""
    order, reach, most = 8, 4, 300
    few = np.arange(m, most + 1.0)
    count, n = order + 1 - m, len(few)
    alpha = np.concatenate([polarisability(s, few, r) for s, r in zip(two.contrasts, two.resistances, strict=True)])
    swapped = Two(two.apart, two.radii[::-1], two.contrasts[::-1], two.resistances[::-1])
    full = np.zeros((2 * n, 2 * n))
    full[:n, n:], full[n:, :n] = direct(two, few, m), direct(swapped, few, m)
    low = np.concatenate([np.arange(count), n + np.arange(count)])
    known = np.where(np.tile(few, 2)[:, None] <= reach, full[:, low], 0.0)
    # e = T (r - alpha e), b = r - alpha e.
    answered = np.linalg.solve(np.eye(2 * n) + full * alpha, known)[low]
    expected = answered @ np.linalg.inv(np.eye(2 * count) - alpha[low, None] * answered)
    found = exchanged(two, order, m, reach)
    assert_allclose(found, expected[:count], rtol=0, atol=SUMS * np.abs(expected).max())
    assert np.abs(found).max() > 1e-3


# Perfect conductors at .01 take 8 CPU-seconds; at .001 they are among those whose gaps close.
@pytest.mark.parametrize(
    ("gap", "contrast"), slow_but({(0.001, 10.0), (0.1, 0.0)}, [(0.1, math.inf), (0.001, 10.0), (0.1, 0.0)])
)
def test_cubic_arrays(gap, contrast):
    scene = in_order(gap, contrast)
    flux, left = carried_on(scene)
    exact = lattice.conductivity("sc", contrast, 4 / 3 * math.pi * scene.inclusions[0].radius ** 3)
    assert -flux[2] == pytest.approx(exact, rel=1e-5)
    assert abs(-flux[2] / exact - 1) < left < 1e-4


def apart(*spheres, **load):
    return Scene((1.0, 1.2, 0.9), Material(1.0), list(spheres), **load)


UNLIKE = [
    apart(
        Sphere((0.3, 0.4, 0.3), 0.25, Material(math.inf)),
        Sphere((0.62, 0.62, 0.35), 0.12, Material(30.0), resistance=0.01),
        Sphere((0.8, 0.1, 0.8), 0.2, Material(0.1)),
        gradient=(0.5, -1.0, 2.0),
    ),
    apart(
        Sphere((0.26, 0.4, 0.3), 0.25, Material(100.0)),
        Sphere((0.66, 0.55, 0.6), 0.24, Material(50.0)),
        walls={"x-": 0.0, "x+": 1.0},
    ),
    apart(Sphere((0.0, 0.6, 0.45), 0.4, Material(100.0)), walls={"x-": 0.0, "x+": 1.0}),
]


@pytest.mark.parametrize("scene", UNLIKE, ids=["cell", "walls", "half"])
def test_unlike_spheres_and_mirror_images(scene):
    """Beside all degrees that these gaps ask for."""
    plain = multipole.solve(scene, accuracy=1e-7)
    flux, left = carried_on(scene)
    scale = np.linalg.norm(plain.mean_flux)
    assert plain.stats["pairs"] == 0
    assert np.linalg.norm(flux - plain.mean_flux) < 1e-5 * scale
    assert left < 1e-4


@cache
def closed(gap):
    return multipole.solve(in_order(gap, math.inf), accuracy=1e-3)


def test_gaps_close_as_the_logarithm():
    """Perfect conductors in cubic order: half pi of a logarithm for each gap, of one along the load in a cube."""
    fields = [closed(gap) for gap in (1e-3, 1e-4)]
    found = fields[1].conductivity - fields[0].conductivity
    # Both are known to a thousandth, and mostly better.
    assert found == pytest.approx(math.pi / 2 * math.log(10), abs=2e-3 * fields[1].conductivity)
    assert [field.stats["pairs"] for field in fields] == [6, 6]
    lower, upper = fields[0].error.lower, fields[0].error.upper
    assert lower < 11.26797 < upper


def test_spheres_that_touch():
    """As those that nearly do, and less than perfect ones of that gap."""
    fields = [multipole.solve(in_order(gap, 100.0), accuracy=1e-3) for gap in (0.0, 1e-7)]
    assert fields[0].conductivity == pytest.approx(fields[1].conductivity, rel=1e-4)
    assert fields[0].conductivity < closed(1e-4).conductivity


def test_loads_share_pairs(monkeypatch):
    made = []

    class Counted(contacts.Contacts):
        def __init__(self, *arguments):
            made.append(self)
            super().__init__(*arguments)

    monkeypatch.setattr(contacts, "Contacts", Counted)
    fields = multipole.solve_axes(in_order(1e-3, math.inf), accuracy=1e-2)
    assert len(made) == max(len(field.stats["convergence"]) for field in fields) - 1
    assert_allclose(fields[0].conductivity, fields[2].conductivity, rtol=1e-6)


def test_what_does_not_fit_is_said(monkeypatch):
    monkeypatch.setattr(contacts, "ORDERS", (16,))
    with pytest.raises(RuntimeError, match=r"at order 16 .* smallest gap is 0.0005 m, .* must be 1.0e-05") as error:
        multipole.solve(in_order(1e-3, math.inf))
    assert "\n" not in str(error.value)
