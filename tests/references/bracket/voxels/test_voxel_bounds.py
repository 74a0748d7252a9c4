"""Bounds on voxels hold what is known exactly, wherever iterations stop, and close in with the grid."""

import numpy as np
import pytest

from demheat import gallery
from demheat.scene import Layer, Material, Scene, Sphere
from references import exact, multipole
from references.bracket import voxels
from references.bracket.voxels import image, solver

# Of bounds that are both exact but for what counts as rounding, 1e-11 each way.
EXACT = 1e-10


def laminate(axis):
    """Four kinds of layers across an axis; conductivities along each axis."""
    values = np.array([1.0, 5.0, 0.2, 3.0])
    known = np.full(3, values.mean())
    known[axis] = 1 / np.mean(1 / values)
    return np.moveaxis(values.reshape(4, 1, 1), 0, axis), known


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_laminates_are_exact(axis):
    values, known = laminate(axis)
    values = np.broadcast_to(values, [4 if a == axis else 3 for a in range(3)])
    for gradient in (*np.eye(3), (1.0, -2.0, 0.5)):
        along = np.array(gradient) / np.linalg.norm(gradient)
        found = voxels.bounds(values, (0.5, 1.0, 2.0), gradient=gradient, tolerance=1e-14)
        assert found.lower <= known @ along**2 <= found.upper
        assert found.width < EXACT


def four_phases(k, *, refine=1):
    """Squares k1 k2 above k4 k3 repeated, along x; Craster and Obnosov, SIAM J. Appl. Math. 61 (2001) 1839."""
    a, b, c, d = k
    triples = a * b * c + a * b * d + a * c * d + b * c * d
    known = np.sqrt(triples / (a + b + c + d) * (a + d) * (b + c) / ((a + b) * (d + c)))
    values = np.array([[a, d], [b, c]])[:, :, None]
    return voxels.bounds(values, (0.5, 0.5, 1.0), refine=refine), known


@pytest.mark.parametrize("k", [(1.0, 10.0, 1.0, 10.0), (1.0, 3.0, 0.2, 5.0)])
def test_checkerboards_close_in_on_their_exact_value(k):
    found, widths = [four_phases(k, refine=n) for n in (1, 4, 8, 16)], []
    for each, known in found:
        assert each.lower < known < each.upper
        widths.append(each.width)
    # Near a corner of squares the temperature goes as the distance to a power: the energy of what a grid misses as its
    # size to twice that. Of contrast 10 the power is 4/pi arctan(10^-1/2), .39; that of the other is larger.
    power = 4 / np.pi * np.arctan(10**-0.5)
    orders = np.log2(np.array(widths[1:-1]) / widths[2:])
    assert np.all(orders > 2 * power - 0.1)


SPHERES = {
    "conducting": gallery.simple_cubic(10.0, fraction=0.3),
    "insulating": gallery.sphere_in_cube(0.01, periodic=True),
    "walls": gallery.sphere_in_cube(10.0),
    "touching": gallery.simple_cubic(5.0, fraction=np.pi / 6),
    "coated": gallery.coated_sphere(),
}


@pytest.mark.parametrize("name", SPHERES)
def test_bounds_hold_the_exact_value_of_a_scene(name):
    scene = SPHERES[name]
    known, found = exact.solve(scene).conductivity, voxels.solve(scene, voxels=12)
    assert found.lower < known < found.upper
    # The true value is no end.
    assert 0.05 < (known - found.lower) / (found.upper - found.lower) < 0.95
    assert found.stats["cut"] > 100
    assert found.stats["unbalanced"] < 1e-12


def test_bounds_of_a_scene_close_in_with_first_order():
    scene = SPHERES["conducting"]
    known = exact.solve(scene).conductivity
    found = [voxels.solve(scene, voxels=n) for n in (8, 16, 32)]
    assert all(each.lower < known < each.upper for each in found)
    gaps = np.array([(each.upper - known, known - each.lower) for each in found])
    orders = np.log(gaps[0] / gaps[-1]) / np.log(4)
    # Theory 1: voxels that the surface cuts are a share of all that goes as their size. Few of them are not regular.
    assert np.all(orders > 0.8)


def test_where_no_iteration_is_made_bounds_are_those_of_voigt_and_reuss(monkeypatch):
    values = np.random.default_rng(0).uniform(0.1, 3.0, (4, 3, 5))
    full = voxels.bounds(values, gradient=(1, 2, 0))
    monkeypatch.setattr(image, "ITERATIONS", 0)
    found = voxels.bounds(values, gradient=(1, 2, 0))
    assert found.upper == pytest.approx(values.mean(), rel=EXACT)
    assert found.lower == pytest.approx(1 / np.mean(1 / values), rel=EXACT)
    narrower = [found]
    for most in (1, 3):
        monkeypatch.setattr(image, "ITERATIONS", most)
        narrower.append(voxels.bounds(values, gradient=(1, 2, 0)))
    narrower.append(full)
    for one, other in zip(narrower, narrower[1:], strict=False):
        assert one.lower < other.lower < other.upper < one.upper


def least_by_hand(values, spacing, gradient):
    """The least energies over all trilinear temperatures and all balanced fluxes, by dense matrices."""
    shape = values.shape
    number = np.arange(values.size).reshape(shape)
    pairs = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    slopes, masses, means = [], [], np.zeros((3 * values.size, 3))
    flux, rest = np.zeros((3 * values.size,) * 2), np.zeros((values.size, 3 * values.size))
    for place in np.ndindex(shape):
        corner = np.array([number[tuple((np.array(place) + s) % shape)] for s in np.ndindex(2, 2, 2)]).reshape(2, 2, 2)
        for axis in range(3):
            ends = np.moveaxis(corner, axis, 0).reshape(2, 4)
            slope = np.zeros((4, values.size))
            np.add.at(slope, (range(4), ends[1]), 1 / spacing[axis])
            np.add.at(slope, (range(4), ends[0]), -1 / spacing[axis])
            slopes.append((slope, np.full(4, gradient[axis])))
            masses.append(values[place] * np.kron(pairs, pairs))
            faces = values.size * axis + ends[:, 0]
            np.add.at(flux, np.ix_(faces, faces), pairs / values[place])
            np.add.at(rest, (number[place], faces), np.array([-1, 1]) / spacing[axis])
            means[faces[0], axis] += 1 / values.size
    stiff = sum(s.T @ m @ s for (s, _), m in zip(slopes, masses, strict=True))
    pull = sum(s.T @ m @ g for (s, g), m in zip(slopes, masses, strict=True))
    whole = sum(g @ m @ g for (_, g), m in zip(slopes, masses, strict=True))
    upper = (whole - pull @ np.linalg.pinv(stiff) @ pull) / values.size
    held = np.vstack([rest, means @ gradient])
    right = np.append(np.zeros(3 * values.size + values.size), 1.0)
    system = np.block([[flux, held.T], [held, np.zeros((len(held),) * 2)]])
    found = np.linalg.lstsq(system, right, rcond=None)[0][: 3 * values.size]
    return values.size / (found @ flux @ found), upper


def test_bounds_are_the_best_of_their_fields():
    rng = np.random.default_rng(1)
    for shape in ((3, 4, 2), (4, 1, 3)):
        values, spacing, gradient = (
            rng.uniform(0.1, 3.0, shape),
            np.array([1.0, 0.6, 1.7]),
            np.array([2.0, -1.0, 2.0]) / 3,
        )
        lower, upper = least_by_hand(values, spacing, gradient)
        found = voxels.bounds(values, spacing, gradient=5 * gradient, tolerance=1e-14)
        # The energy is flat at its least: the tolerance, besides what counts as rounding.
        assert found.lower == pytest.approx(lower, rel=EXACT)
        assert found.upper == pytest.approx(upper, rel=EXACT)


def test_one_bound_is_that_of_both():
    values = np.random.default_rng(2).uniform(0.1, 3.0, (4, 3, 5))
    both = voxels.bounds(values, gradient=(0, 1, 0), refine=2)
    assert voxels.upper_bound(values, gradient=(0, 1, 0), refine=2) == both.upper


def test_what_counts_as_rounding_is_taken_off_both_bounds(monkeypatch):
    """Of places, so much of the contrast for each body twice, which 1e-12 of the box hides."""
    scene = gallery.sphere_in_cube(5.0)
    here = voxels.solve(scene, voxels=4)
    monkeypatch.setattr(solver, "GRAIN", 1e-3)
    there = voxels.solve(scene, voxels=4)
    assert there.lower == pytest.approx(here.lower * (1 - 2e-3 * 5), rel=EXACT)
    assert there.upper == pytest.approx(here.upper * (1 + 2e-3 * 5), rel=EXACT)


def test_axes_units_and_threads_change_nothing():
    values = np.random.default_rng(3).uniform(0.1, 3.0, (4, 3, 5))
    here = voxels.bounds(values, (1.0, 2.0, 0.5), gradient=(1, 2, 3), tolerance=1e-12)
    there = voxels.bounds(
        1e9 * values.transpose(2, 0, 1), (0.5e-9, 1e-9, 2e-9), gradient=(3e5, 1e5, 2e5), tolerance=1e-12
    )
    # Iterations stop at a tolerance on the energy, of which rounding decides.
    assert there.lower == pytest.approx(1e9 * here.lower, rel=1e-10)
    assert there.upper == pytest.approx(1e9 * here.upper, rel=1e-10)
    one = voxels.bounds(values, (1.0, 2.0, 0.5), gradient=(1, 2, 3), tolerance=1e-12, threads=1)
    assert (one.lower, one.upper) == (here.lower, here.upper)


def test_walls_without_mirror_planes():
    """Off the middle, one sphere cut by a wall, another across two mirrors, and a layer; beside finite elements."""
    fem = pytest.importorskip("references.fem")
    spheres = [Sphere((0.1, 0.5, 0.3), 0.25, Material(8.0)), Sphere((0.6, 0.95, 1.0), 0.2, Material(0.2))]
    layer = Layer(0, 0.85, 0.95, Material(3.0))
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), [*spheres, layer], walls={"x-": 3.0, "x+": -1.0})
    found = voxels.solve(scene, voxels=10)
    assert found.stats["voxels"] == (20, 20, 20)
    assert found.lower < fem.solve(scene, size=0.08).conductivity < found.upper
    assert found.width < 0.3


def test_many_spheres_between_walls_beside_multipoles():
    scene = gallery.random_dispersion(8, periodic=False, diameter=0.3, seed=1)
    found = voxels.solve(scene, voxels=16)
    assert found.lower < multipole.solve(scene, accuracy=1e-5).conductivity < found.upper


def test_pores_have_an_upper_bound():
    values = np.ones((4, 1, 1))
    values[1] = 0.0
    assert voxels.upper_bound(values, gradient=(0, 1, 0)) == pytest.approx(0.75, rel=EXACT)
    # The temperature falls within the pore alone.
    assert voxels.upper_bound(values, gradient=(1, 0, 0)) == pytest.approx(0, abs=1e-10)
    assert voxels.upper_bound(np.zeros((2, 2, 2))) == 0
    with pytest.raises(NotImplementedError, match="upper_bound takes pores"):
        voxels.bounds(values)
    with pytest.raises(NotImplementedError, match="a conductivity is 0"):
        voxels.solve(gallery.simple_cubic(0.0, fraction=0.3), voxels=4)


def test_bad_scenes():
    one = Scene((1.0, 1.0, 1.0), Material(1.0), walls={"y-": 0.0})
    with pytest.raises(NotImplementedError, match="one pair of isothermal walls"):
        voxels.solve(one)
    with pytest.raises(ValueError, match="voxels = 3000"):
        voxels.solve(gallery.simple_cubic(), voxels=3000)
