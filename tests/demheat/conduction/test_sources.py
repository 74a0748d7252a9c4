"""Only here: power of sources that is lost at rims, jitters between cells or falls beside where they are."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.conduction import sources
from demheat.conduction.sources import check_sources, lost_power, source_power, total_power, transits
from demheat.network.laguerre import laguerre
from demheat.packing.radii import Uniform
from demheat.packing.relax import relax
from demheat.scene import Material, MovingCylinder, Scene, UniformSource

METAL = Material(134.0, density=2790.0, heat_capacity=880.0)


def sheet(*made, **more):
    """The sheet of Terreros et al. (2013), section 5."""
    return Scene(**({"size": (0.05, 0.03, 0.002), "matrix": METAL, "initial": 25.0, "sources": made} | more))


def laser(**more):
    start = {"axis": 2, "diameter": 0.008, "power_density": 1e11, "start": (0.02, 0.015), "velocity": (0.0033, 0.0)}
    return MovingCylinder(**(start | more))


FULL = 1e11 * math.pi / 4 * 0.008**2 * 0.002


@pytest.fixture(scope="module")
def cells():
    """Centres, radical weights and volumes of a packing of the sheet."""
    packing = relax(1500, size=(0.05, 0.03, 0.002), radii=Uniform(0.075), periodic=False, overlap=0.02)
    facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=False)
    return packing.centers, packing.radii**2, facets.volumes


def test_uniform_heating(cells):
    centers, _, volumes = cells
    scene = sheet(UniformSource(5e6))
    assert_allclose(source_power(scene, centers, volumes)(3.0), 5e6 * volumes, rtol=1e-12)
    # Volumes sum to the body's to 1e-12.
    assert_allclose(source_power(scene, centers, volumes)(3.0).sum(), total_power(scene, 3.0), rtol=1e-12)
    assert lost_power(scene, 3.0) == 0.0
    assert source_power(sheet(), centers, volumes) is None


def test_power_is_conserved_at_every_time(cells):
    centers, _, volumes = cells
    power = source_power(sheet(laser()), centers, volumes)
    for time in np.linspace(0.0, 7.878, 41):
        # One scaling and a sum of some hundred terms: rounding.
        assert_allclose(power(time).sum(), FULL, rtol=1e-14)
    clipped = sheet(laser(clip=True), UniformSource(1e8))
    power = source_power(clipped, centers, volumes)
    for time in np.linspace(0.0, 12.0, 41):
        assert_allclose(power(time).sum(), total_power(clipped, time), rtol=1e-12)
        assert_allclose(total_power(clipped, time) + lost_power(clipped, time), FULL + 1e8 * clipped.volume, rtol=1e-14)


def test_heat_falls_where_the_source_is(cells):
    """Against points drawn in the source, each given to the radical cell that holds it."""
    centers, weights, volumes = cells
    power = source_power(sheet(laser()), centers, volumes)
    rng = np.random.default_rng(0)
    for time in (0.0, 2.3):
        place, (u, v, w) = laser().position(time), rng.random((3, 20_000))
        ring = 0.004 * np.sqrt(u)
        points = np.column_stack([*(place[:, None] + ring * [np.cos(2 * np.pi * v), np.sin(2 * np.pi * v)]), 0.002 * w])
        near = np.flatnonzero(np.linalg.norm(centers[:, :2] - place, axis=1) < 0.008)
        away = ((points[:, None, :] - centers[near]) ** 2).sum(axis=2) - weights[near]
        counted = np.bincount(near[away.argmin(axis=1)], minlength=len(centers)) / len(points)
        got = power(time) / FULL
        # Part of the heat in wrong cells: found 1.2 % by 4e5 points; 2e4 points misplace 0.4 sqrt(cells/points) = 2 %.
        assert np.abs(got - counted).sum() / 2 < 0.04
        middle = got @ centers[:, :2] - counted @ centers[:, :2]
        # Found 2 % of the mean spacing; the mean of the points is known to 0.002/sqrt(2e4) = 1.4e-5 m.
        assert np.abs(middle).max() < 0.02 * np.cbrt(volumes.mean()) + 4.2e-5


def test_powers_do_not_jitter(cells):
    centers, _, volumes = cells
    power = source_power(sheet(laser()), centers, volumes)
    changes = []
    for step in (2e-3, 2e-4, 2e-5):
        times = 1.0 + step * np.arange(20)
        changes.append(np.abs(np.diff([power(time) for time in times], axis=0)).max())
    # The change over a step is as long as the step: no cell jumps. Over 20 steps of 7 um speeds vary a little.
    assert_allclose(changes[:2] / np.array(changes[1:]), 10.0, rtol=0.3)
    # Nor faster than the rim: a cell is crossed in no less than a third of its diameter over the speed.
    crossing = np.cbrt(volumes.mean()) / 3 / 0.0033
    assert changes[2] < volumes.max() * 1e11 * 2e-5 / crossing


def test_a_source_that_leaves():
    """Rim at the far edge after (50 - 20 - 4)/3.3 s = 7.8788 s."""
    check_sources(sheet(laser()), 7.8787)
    with pytest.raises(ValueError, match=r"sources\[1\].*at 7\.8787\d s.*x and y = \[0\.046"):
        check_sources(sheet(UniformSource(1.0), laser()), 8.0)
    with pytest.raises(ValueError, match="at 0 s"):
        check_sources(sheet(laser(start=(0.003, 0.015))), 1.0)
    check_sources(sheet(laser(clip=True)), 100.0)
    late = source_power(sheet(laser()), np.full((1, 3), 0.01), np.ones(1))
    with pytest.raises(ValueError, match="at 8 s.*clip=True"):
        late(8.0)


def test_a_clipped_source():
    scene = sheet(laser(clip=True))
    assert lost_power(scene, 7.0) == 0.0
    half = (0.05 - 0.02) / 0.0033
    # Axis on the edge, then corner: a half and a quarter, to rounding of the time.
    assert_allclose(total_power(scene, half), FULL / 2, rtol=1e-12)
    assert_allclose(lost_power(scene, half), FULL / 2, rtol=1e-12)
    assert_allclose(total_power(sheet(laser(start=(0.05, 0.03), clip=True)), 0.0), FULL / 4, rtol=1e-12)
    assert total_power(scene, 20.0) == 0.0 and lost_power(scene, 20.0) == FULL
    power = source_power(scene, np.array([[0.049, 0.015, 0.001], [0.01, 0.015, 0.001]]), np.full(2, 1e-9))
    assert not power(20.0).any()


@pytest.mark.parametrize(
    "low, high", [((-0.3, -2.0), (0.5, 0.4)), ((0.2, 0.1), (2.0, 0.6)), ((-0.9, -0.2), (-0.7, 2.0))]
)
def test_disc_in_rectangle(low, high):
    x = (np.arange(200_000) + 0.5) / 1e5 - 1.0
    chord = np.minimum(np.sqrt(1 - x**2), high[1]) - np.maximum(-np.sqrt(1 - x**2), low[1])
    slow = np.sum(np.maximum(chord, 0.0)[(x > low[0]) & (x < high[0])]) / 1e5
    # Midpoint rule with step 1e-5, off by that much where the limits or kinks are.
    assert_allclose(9.0 * slow, sources._disc_in_rectangle(3.0, 3 * np.array(low), 3 * np.array(high)), atol=2e-4)


def test_overlap_of_spheres_and_cylinder():
    # Cylinder of radius w through the middle of a sphere of radius r: 1 - (1 - (w/r)^2)^(3/2) of it; slices find
    # it to 6e-3 where the cylinder is thinner than the sphere.
    assert_allclose(sources._overlap(np.zeros(1), np.array([2.0]), 1.2), 1 - 0.64**1.5, atol=1e-2)
    rng = np.random.default_rng(1)
    ball = rng.uniform(-1, 1, (400_000, 3))
    ball = ball[(ball**2).sum(axis=1) < 1]
    apart = np.array([0.0, 0.3, 1.4, 2.0, 2.4, 2.95, 3.1])
    counted = [np.mean(np.hypot(ball[:, 0] + d, ball[:, 1]) < 2.0) for d in apart]
    # 2e5 points: 1.1e-3 each, three times that, and the slices' 1e-3.
    assert_allclose(sources._overlap(apart, np.ones(7), 2.0), counted, atol=4.3e-3)


def test_a_source_thinner_than_the_gaps():
    scene = sheet(laser(diameter=1e-5))
    centers = np.random.default_rng(3).random((40, 3)) * scene.size
    power = source_power(scene, centers, np.full(40, 1e-12))
    assert_allclose(power(1.0).sum(), total_power(scene, 1.0), rtol=1e-14)
    assert np.argmax(power(1.0)) == np.argmin(np.linalg.norm((centers - [0.0233, 0.015, 0])[:, :2], axis=1))


def test_round_bodies():
    source = laser(axis=0, diameter=0.01, start=(0.01, 0.015), velocity=(0.0, 0.001), clip=True)
    rod = sheet(source, size=(0.05, 0.03, 0.03), domain="cylinder-x")
    full = 1e11 * math.pi / 4 * 0.01**2 * 0.05
    # Axis 5 mm off the middle of a disc of 15 mm: touches at 10 mm, after sqrt(75) mm of its way.
    assert_allclose(total_power(rod, 8.66), full, rtol=1e-14)
    assert 0 < lost_power(rod, 8.70) < 1e-3 * full
    assert lost_power(rod, 40.0) == full
    packing = relax(300, size=rod.size, domain="cylinder-x", periodic=False, overlap=0.02)
    facets = laguerre(packing.centers, packing.radii**2, packing.size, periodic=False, domain="cylinder-x")
    for time in (0.0, 8.7, 16.0):
        got = source_power(rod, packing.centers, facets.volumes)(time).sum()
        assert_allclose(got, total_power(rod, time), rtol=1e-13)


@pytest.mark.parametrize("domain, axis", [("sphere", 2), ("cylinder-x", 2)])
def test_ways_that_are_not_straight_through(domain, axis):
    scene = Scene(size=(1, 1, 1), matrix=METAL, initial=0.0, domain=domain, sources=[laser(axis=axis, diameter=0.1)])
    for ask in (lambda: source_power(scene, np.zeros((1, 3)), np.ones(1)), lambda: check_sources(scene, 1.0)):
        with pytest.raises(NotImplementedError, match=f"along z in a {domain}"):
            ask()


def test_volumes_that_do_not_fill_the_body_get_its_power(cells):
    """The Platonic law's volumes carry the heat capacity and sum to more than the body."""
    centers, _, volumes = cells
    scene = sheet(UniformSource(5e6))
    given = source_power(scene, centers, 1.1 * volumes)(0.0)
    # A quotient of sums.
    assert_allclose(given.sum(), 5e6 * scene.volume, rtol=1e-14)
    assert_allclose(given / volumes, given[0] / volumes[0], rtol=1e-13)


@pytest.mark.parametrize("domain", ["box", "cylinder-z"])
@pytest.mark.parametrize("start, velocity", [((-1.0, 0.02), (0.5, 0.0)), ((0.07, 0.2), (-0.1, -0.4))])
def test_times_at_which_a_source_meets_and_leaves_the_body(domain, start, velocity):
    source = laser(diameter=0.02, start=start, velocity=velocity, clip=True)
    scene = sheet(source, size=(0.05, 0.05, 0.002), domain=domain)
    ((first, last, crossing),) = transits(scene)
    assert crossing == pytest.approx(0.02 / math.hypot(*velocity))
    assert total_power(scene, first - 1e-6) == total_power(scene, last + 1e-6) == 0.0
    # From a thousandth of its own length on, well above the part of 1e-9 that counts as touching.
    assert total_power(scene, first + 1e-3 * crossing) > 0 < total_power(scene, last - 1e-3 * crossing)


def test_sources_that_stand_still_or_pass_by():
    assert transits(sheet(UniformSource(1.0), laser(velocity=(0.0, 0.0)))) == [(-math.inf, math.inf, math.inf)]
    with pytest.raises(ValueError, match="never meets the box"):
        sheet(laser(start=(0.02, 0.0341), clip=True))
    # Past the corner, by the diagonal: 0.1 mm less and more than the radius of 4 mm.
    near, far = (np.array([0.05, 0.03]) + gap / math.sqrt(2) + np.array([-1.0, 1.0]) for gap in (0.0039, 0.0041))
    assert len(transits(sheet(laser(start=near, velocity=(1.0, -1.0), clip=True)))) == 1
    with pytest.raises(ValueError, match="never meets the box"):
        sheet(laser(start=far, velocity=(1.0, -1.0), clip=True))
