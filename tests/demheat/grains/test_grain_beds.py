"""Only here: beds of grains beside crystals by hand, and what any bed owes."""

import numpy as np
import pytest
from beds import NEAREST, RADIUS, SITES, crystal, random_bed
from numpy.testing import assert_allclose

from demheat import Flux, grains
from demheat.grains import Contacts, Fixed, Gap, Hertz
from demheat.packing import make_packing

K, RATIO = 2.0, 0.1
ACROSS = {"z-": 1.0, "z+": 3.0}
AIR = Gap(conductivity=0.03)
# Sums of some hundred flows, solved to 1e-10.
SOLVED = 1e-8


def tensor(packing, **knobs):
    """Conductivity tensor of a periodic cell by three loads."""
    fields = [grains.solve(packing, K, gradient=tuple(row), **knobs) for row in np.eye(3)]
    return -np.stack([field.mean_flux for field in fields], axis=1)


@pytest.mark.parametrize("kind", SITES)
def test_crystals_of_touching_grains(kind):
    """Every link of the crystal sees the mean gradient: k = links per volume times C d^2 / 3."""
    nearest, count = NEAREST[kind]
    edge = 2 * RADIUS / nearest
    expected = len(SITES[kind]) * count / 2 * (2 * K * RATIO * RADIUS) * (2 * RADIUS) ** 2 / 3 / edge**3
    found = tensor(crystal(kind), contact=Fixed(ratio=RATIO))
    # Rounding, and the tolerance of a solve that has nothing to do.
    assert_allclose(found, expected * np.eye(3), atol=1e-12 * expected)


@pytest.mark.parametrize("layers", [5])
def test_a_cubic_array_between_walls_has_no_ends(layers):
    """Walls are mirrors: k = C / (2 R) by any number of layers, medium included, and with layers that are held."""
    bed = crystal("sc", (3, 3, layers), periodic=(True, True, False))
    for gap in (None, AIR):
        cell = grains.solve(crystal("sc"), K, gradient=(0, 0, 1), contact=Fixed(ratio=RATIO), gap=gap).conductivity
        field = grains.solve(bed, K, walls=ACROSS, contact=Fixed(ratio=RATIO), gap=gap)
        assert_allclose(field.conductivity, cell, rtol=SOLVED)
        assert_allclose(field.wall_heat["z+"], cell * 36 * RADIUS**2 * 2 / (2 * RADIUS * layers), rtol=SOLVED)
        assert_allclose(field.temperature, 1 + 2 * bed.centers[:, 2] / bed.size[2], rtol=SOLVED)
        held = grains.solve(bed, K, walls=ACROSS, contact=Fixed(ratio=RATIO), gap=gap, layer=1.01 * RADIUS)
        assert_allclose(held.conductivity, cell, rtol=SOLVED)
        # What holds a layer conducts 1e4 times what its grains do.
        assert_allclose(held.temperature[bed.centers[:, 2] < 2 * RADIUS], 1.0, atol=2e-4)
    assert cell > 2 * K * RATIO * RADIUS / (2 * RADIUS)


def test_two_solids_are_in_series():
    bed = crystal("sc", (3, 3, 2), periodic=(True, True, False))
    k = np.where(bed.centers[:, 2] < 2 * RADIUS, 2.0, 6.0)
    field = grains.solve(bed, k, walls=ACROSS, contact=Fixed(ratio=RATIO))
    # Half a contact in each grain, on both of its sides: 4 a k each.
    resistance = 2 / (4 * RATIO * RADIUS * 2.0) + 2 / (4 * RATIO * RADIUS * 6.0)
    assert_allclose(field.conductivity, 4 * RADIUS / (resistance * 4 * RADIUS**2), rtol=SOLVED)


@pytest.mark.parametrize("gap", [None, AIR])
def test_heat_balances_in_each_grain(gap):
    field = grains.solve(random_bed(), K, walls=ACROSS, gap=gap)
    passing = abs(field.wall_heat["z+"])
    assert passing > 0 and abs(sum(field.wall_heat.values())) < SOLVED * passing
    assert np.abs(field.imbalance).max() < SOLVED * passing
    known = field.temperature[np.isfinite(field.temperature)]
    # Maximum principle, to the solver's tolerance.
    assert known.min() > 1 - SOLVED and known.max() < 3 + SOLVED
    rise = field.temperature[field.pairs.second] - field.temperature[field.pairs.first]
    assert_allclose(field.heat, np.nan_to_num(field.pairs.conductance * rise), atol=SOLVED * passing)


def test_the_tensor_of_a_periodic_bed_is_symmetric():
    k = tensor(random_bed(periodic=True), gap=AIR)
    assert_allclose(k, k.T, atol=SOLVED * np.trace(k))
    assert np.linalg.eigvalsh(0.5 * (k + k.T)).min() > 0


def test_neither_order_nor_scale_nor_units_matter():
    bed, rng = random_bed(), np.random.default_rng(1)
    first = grains.solve(bed, K, walls=ACROSS, gap=AIR)
    order = rng.permutation(bed.number)
    mixed = bed._replace(centers=bed.centers[order], radii=bed.radii[order])
    second = grains.solve(mixed, K, walls=ACROSS, gap=AIR)
    assert_allclose(second.conductivity, first.conductivity, rtol=SOLVED)
    assert_allclose(second.temperature, first.temperature[order], rtol=SOLVED)
    larger = grains.solve(bed.scaled(1000.0), 10 * K, walls={"z-": 0.0, "z+": 7.0}, gap=Gap(conductivity=0.3))
    assert_allclose(larger.conductivity, 10 * first.conductivity, rtol=SOLVED)


def test_walls_are_reciprocal():
    """What a degree at one wall sends into another is what a degree at that one sends back."""
    bed, cold = random_bed(periodic=(False, False, False)), {"x-": 0.0, "x+": 0.0, "z-": 0.0}
    for one, other in (("x-", "z-"), ("x+", "x-")):
        there, back = (grains.solve(bed, K, walls=cold | {hot: 1.0}, gap=AIR) for hot in (one, other))
        assert there.wall_heat[other] < 0
        assert_allclose(there.wall_heat[other], back.wall_heat[one], rtol=1e-7)
    reverse, first = (grains.solve(bed, K, walls=walls, gap=AIR) for walls in ({"z-": 3.0, "z+": 1.0}, ACROSS))
    known = np.isfinite(first.temperature)
    assert known.sum() > 50 and np.array_equal(known, np.isfinite(reverse.temperature))
    assert_allclose((reverse.temperature + first.temperature)[known], 4.0, rtol=SOLVED)


def test_rattlers_have_no_temperature_and_carry_nothing():
    bed = crystal("sc", (3, 3, 3), apart=0.2, periodic=(True, True, False))
    centers = bed.centers.copy()
    # One column in contact from wall to wall; all others float.
    column = (np.abs(centers[:, 0] - 1.1 * RADIUS) < 1e-9) & (np.abs(centers[:, 1] - 1.1 * RADIUS) < 1e-9)
    radii = np.where(column, 1.1 * RADIUS, RADIUS)
    field = grains.solve(bed._replace(radii=radii), K, walls=ACROSS, contact=Fixed(ratio=RATIO))
    assert column.sum() == 3 and np.array_equal(np.isnan(field.temperature), ~column)
    # Three contacts in a row, two halves of them at the walls.
    expected = 2 * K * RATIO * 1.1 * RADIUS / 3 * 2.0
    assert_allclose(field.wall_heat["z+"], expected, rtol=SOLVED)
    assert field.stats["islands"] == 24


def test_a_periodic_bed_that_nothing_crosses_conducts_nothing():
    field = grains.solve(crystal("sc", apart=0.2), K, gradient=(0, 0, 1), contact=Fixed(ratio=RATIO))
    assert field.conductivity == 0 and len(field.heat) == 0
    assert grains.solve(crystal("sc", apart=0.2), K, gradient=(0, 0, 1), gap=AIR).conductivity > 0


def test_contacts_of_a_list():
    bed = crystal("sc", (3, 3, 3), periodic=(True, True, False))
    whole = grains.solve(bed, K, walls=ACROSS, contact=Fixed(ratio=RATIO), layer=1.01 * RADIUS)
    pairs = whole.pairs
    swapped = Contacts(pairs.second, pairs.first, pairs.radius)
    listed = grains.solve(bed, K, walls=ACROSS, contact=swapped, layer=1.01 * RADIUS)
    assert_allclose(listed.heat, whole.heat, rtol=SOLVED, atol=1e-12)
    # A force along the branch that presses a contact of the same radius, and one that pulls.
    radius = RATIO * RADIUS
    force = 4 * radius**3 * 1e9 / (3 * RADIUS / 2 * 2 * (1 - 0.3**2))
    branch = whole.packing.centers[pairs.second] - whole.packing.centers[pairs.first]
    branch -= np.where(bed.periodic, bed.size * np.round(branch / bed.size), 0.0)
    push = -force * branch / (2 * RADIUS)
    forced = Contacts(pairs.first, pairs.second, force=push).pressed(bed, Hertz(young=1e9))
    assert_allclose(forced.radius, radius, rtol=1e-9)
    some = np.where(np.arange(len(push))[:, None] < 3, -push, push)
    pulled = Contacts(pairs.first, pairs.second, force=some).pressed(bed, Hertz(young=1e9))
    assert np.array_equal(pulled.radius == 0, np.arange(len(push)) < 3)
    with pytest.raises(ValueError, match="presses no two grains together"):
        Contacts(pairs.first, pairs.second, force=-push).pressed(bed, Hertz(young=1e9))
    with pytest.raises(ValueError, match="Contacts.force = None"):
        swapped.pressed(bed, Hertz(young=1e9))
    assert_allclose(forced.scaled(1e3).radius, 1e3 * radius, rtol=1e-9)


BED = crystal("sc", (3, 3, 3), periodic=(True, True, False))


@pytest.mark.parametrize(
    ("knobs", "error", "message"),
    [
        ({}, ValueError, "must be one of them"),
        ({"walls": ACROSS, "gradient": (0, 0, 1)}, ValueError, "must be one of them"),
        ({"gradient": (0, 0, 1.0)}, ValueError, "must be 0 along z, where the packing has walls"),
        ({"walls": {"x-": 1.0, "x+": 2.0}}, ValueError, "must be among z-, z\\+"),
        ({"walls": {"z-": 1.0, "up": 2.0}}, ValueError, "up"),
        ({"walls": {"z-": 1.0, "z+": Flux(3.0)}}, NotImplementedError, "walls with constant temperatures only"),
        ({"walls": {}}, ValueError, "must map at least one of"),
        ({"walls": {"z-": 1.0, "z+": np.nan}}, ValueError, "z\\+"),
        ({"walls": ACROSS}, ValueError, "no grain exchanges heat with it, the nearest surface is"),
        ({"walls": ACROSS, "contact": "hertz"}, ValueError, "contact = 'hertz': must be Overlap"),
        ({"walls": ACROSS, "gap": 0.026}, ValueError, "gap = 0.026: must be a Gap"),
        ({"walls": ACROSS, "gap": AIR, "layer": 1.0}, ValueError, "layer = 1.0: must be a number > 0 m, below half"),
        ({"gradient": (1.0, 0, 0), "layer": 1e-3}, ValueError, "layer = 0.001: must be left out"),
        ({"walls": ACROSS, "contact": Contacts(np.array([0]), np.array([99]), [1e-4])}, ValueError, "99: must be the"),
        ({"walls": ACROSS, "contact": Contacts(np.array([0]), np.array([1]))}, ValueError, "radius = None"),
        ({"walls": ACROSS, "gap": AIR, "tolerance": 1.0}, ValueError, "tolerance = 1.0: must lie between"),
    ],
)
def test_what_cannot_be_done_is_refused(knobs, error, message):
    bed = BED if "contact" in knobs or "gap" in knobs else BED._replace(radii=0.99 * BED.radii)
    with pytest.raises(error, match=message):
        grains.solve(bed, K, **knobs)


def test_solids_and_places_that_make_no_sense():
    for solid, message in ((0.0, "solid = 0.0: must be"), ([1.0, 2.0], "solid of shape"), ("steel", "solid = 'steel'")):
        with pytest.raises(ValueError, match=message):
            grains.solve(BED, solid, walls=ACROSS, gap=AIR)
    inside = make_packing([[0.5, 0.5, 0.5], [0.52, 0.5, 0.5]], [0.1, 0.05], (1, 1, 1), False, {})
    with pytest.raises(ValueError, match="must not lie in each other"):
        grains.solve(inside, K, walls=ACROSS, gap=AIR)
    with pytest.raises(NotImplementedError, match="the nearest image alone is known"):
        grains.solve(crystal("sc", (2, 3, 3)), K, gradient=(1, 0, 0), gap=AIR)
    with pytest.raises(ValueError, match="layers of two walls share grains"):
        walls = {"x-": 1.0, "z-": 2.0}
        grains.solve(crystal("sc", periodic=False), K, walls=walls, gap=AIR, layer=1.01 * RADIUS)


LONE = make_packing([[1, 1, 1], [3, 3, 3]], [0.4, 0.4], (4, 4, 4), True, {})


def test_a_bed_that_conducts_nothing_says_so():
    with pytest.warns(UserWarning, match="no two grains touch"):
        assert grains.solve(LONE, 10.0, gradient=(0, 0, 1), gap=Gap(conductivity=0.2)).conductivity == 0


def test_walls_of_a_periodic_packing():
    with pytest.raises(ValueError, match="must be a gradient instead"):
        grains.solve(LONE, 10.0, walls={"z-": 0.0, "z+": 1.0})
