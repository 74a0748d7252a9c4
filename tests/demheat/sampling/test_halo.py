"""Only here: a halo that misses a sample, a mirror of the wrong parity, a split of links that loses heat."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Material, Scene, Sphere
from demheat.conduction.steady import solve_steady
from demheat.dem.calibration import calibration, calibration_scene
from demheat.dem.networks import network_of
from demheat.field import Field, Samples
from demheat.laws import Calibrated, Laguerre
from demheat.network.base import branches, link_distances, row_numbers
from demheat.packing.base import make_packing
from demheat.packing.cache import relaxed
from demheat.sampling import halo
from demheat.sampling.field_of import field_of
from demheat.sampling.fluxes import cell_fluxes
from demheat.sampling.halo import halo_average, halo_flux
from demheat.sampling.particle_flux import SPLITS, particle_flux
from demheat.scene import Flux, Layer
from references import exact

SIZE = np.array([1.0, 1.3, 0.8])


def cloud(n=700, d=3, seed=0):
    rng = np.random.default_rng(seed)
    return rng.random((n, 3)) * SIZE, rng.normal(size=(n, d)), rng.uniform(0.5, 2.0, n)


def twin(points, values, volumes, radius, size, periodic, at, phase=None, at_phase=None):
    """Every point with every sample, nearest images."""
    offsets = at[:, None] - points
    offsets -= np.where(periodic, size * np.round(offsets / size), 0.0)
    weight = volumes * (np.linalg.norm(offsets, axis=2) <= radius)
    if phase is not None:
        weight = weight * (at_phase[:, None] == phase)
    with np.errstate(invalid="ignore"):
        return weight @ values / weight.sum(axis=1)[:, None]


@pytest.mark.parametrize(
    ("radius", "periodic", "part", "fewest"),
    [
        (0.05, False, 1 / 2, 8.0),
        (0.21, True, 1 / 7, 0.05),
        (0.4, (True, False, True), 1 / 7, 0.05),
        (0.4, True, 4.0, 1.0),
    ],
)
def test_averages_are_those_of_every_sample(radius, periodic, part, fewest, monkeypatch):
    """Whatever the cells: small ones are summed whole, with large ones every sample is looked at."""
    monkeypatch.setattr(halo, "PART", part)
    monkeypatch.setattr(halo, "FEWEST", fewest)
    points, values, volumes = cloud()
    for at in (None, np.random.default_rng(1).random((50, 3)) * SIZE):
        means = halo_average(points, values, volumes, radius=radius, size=SIZE, periodic=periodic, at=at)
        right = twin(points, values, volumes, radius, SIZE, periodic, points if at is None else at)
        # Rounding of sums of up to 700 numbers.
        assert_allclose(means, right, rtol=0, atol=1e-13)


def test_more_values_and_single_ones():
    points, values, volumes = cloud(d=7)
    where = {"radius": 0.3, "size": SIZE, "periodic": True}
    every = halo_average(points, values, volumes, **where)
    assert every.shape == (700, 7)
    for k in (0, 4, 6):
        one = halo_average(points, values[:, k], volumes, **where)
        assert one.shape == (700,)
        assert_array_equal(one, every[:, k])
    # One point may be given as such; a halo without samples has no mean.
    lone = halo_average(points[:1], [5.0], [2.0], radius=0.3, size=SIZE, periodic=True, at=points[0] + [0.31, 0, 0])
    assert lone.shape == (1,) and np.isnan(lone[0])
    none = halo_average(points, values, volumes, **where, at=np.empty((0, 3)))
    assert none.shape == (0, 7)
    # A sample at the very edge counts.
    edge = halo_average([[0.25, 0.5, 0.5]], [5.0], [2.0], radius=0.25, size=SIZE, periodic=False, at=[0.5, 0.5, 0.5])
    assert edge[0] == 5.0


def test_only_the_same_phase():
    points, values, volumes = cloud()
    phase = (points[:, 0] > 0.5).astype(int) + 3
    at = np.random.default_rng(1).random((50, 3)) * SIZE
    for where, at_phase in ((None, None), (at, np.arange(50) % 3 + 2)):
        here, wanted = (points, phase) if where is None else (at, at_phase)
        means = halo_average(
            points, values, volumes, radius=0.3, size=SIZE, periodic=False, at=where, phases=(phase, wanted)
        )
        right = twin(points, values, volumes, 0.3, SIZE, False, here, phase, wanted)
        assert_allclose(means, right, atol=1e-13)  # rounding, as above
    assert np.isnan(means[at_phase == 2]).all() and np.isfinite(means[at_phase == 3]).any()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"radius": 0.5, "periodic": True}, "radius = 0.5"),
        ({"points": [[2.0, 0, 0], [0, 0, 0]]}, r"points\[0\]"),
        ({"at": [[0.0, np.nan, 0.0]]}, r"at\[0\] = .*: must be finite coordinates"),
        ({"phases": [0, 1, 2]}, "phases = .* a pair"),
        ({"phases": ([0], [0, 1])}, r"phases\[0\] = "),
        ({"phases": ([0.5, 1.5], [0, 1])}, r"phases\[0\] = "),
        ({"phases": ([0, 1], [0, 1]), "at": [[0.0, 0.0, 0.0]]}, r"phases\[1\] = .* 1 whole"),
        ({"phases": ([0, 1], None)}, r"phases\[1\] = None"),
        ({"phases": (None, [0, 1])}, r"phases\[0\] = None"),
    ],
)
def test_bad_input(change, words):
    good = {"points": [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]], "values": [1.0, 2.0], "volumes": [1.0, 1.0]}
    good |= {"radius": 0.1, "size": SIZE, "periodic": False}
    halo_average(**good)
    with pytest.raises(ValueError, match=words):
        halo_average(**good | change)


# ---- Flux of a field -------------------------------------------------------------------------------------------------


def waving(points, load):
    """A flux on all of space that goes on across the walls of the unit cube as that of its walls does.

    T = cos(pi x) f(y) cos(2 pi z) is even at insulated walls; f = sin(pi y) is odd at held ones, y = 0 and 1; with a
    flux at y = 1, f = sin(pi y / 2) is even there, and a linear part of T brings the flux.
    """
    k = np.pi * (0.5 if load is not None else 1.0)
    x, y, z = np.pi * points[:, 0], k * points[:, 1], 2 * np.pi * points[:, 2]
    flux = -np.column_stack(
        [
            -np.pi * np.sin(x) * np.sin(y) * np.cos(z),
            k * np.cos(x) * np.cos(y) * np.cos(z),
            -2 * np.pi * np.cos(x) * np.sin(y) * np.sin(z),
        ]
    )
    flux[:, 1] -= 0.0 if load is None else load
    return flux


def made(scene, points, volumes, flux, mean_radius=0.05):
    """A field with just these samples."""
    samples = Samples(points, volumes, np.zeros(len(points)), scene.phase_at(points), flux)
    stats = {"mean_radius": mean_radius}
    # The mean one that the scene must have, whatever the samples are.
    mean = np.zeros(3) if scene.gradient is None else -np.array(scene.gradient)
    return Field(scene, mean, np.ones(1), lambda: samples, lambda p: p, lambda p: p, stats=stats)


@pytest.mark.parametrize("load", [None, 7.0])
def test_mirrors_carry_on_the_field_beyond_walls(load):
    """Against halos inside a cloud that is mirrored by hand all round, with the flux as it is there."""
    walls = {"y-": 0.0, "y+": 0.0 if load is None else Flux(load)}
    scene = Scene(size=(1, 1, 1), matrix=Material(1.0), walls=walls)
    rng = np.random.default_rng(0)
    points, volumes = rng.random((200, 3)), rng.uniform(0.5, 2.0, 200)
    field = made(scene, points, volumes, waving(points, load))
    all_round, copies = points, volumes
    for axis in range(3):
        images = []
        for wall in (0.0, 1.0):
            image = all_round.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            images.append(image)
        all_round, copies = np.concatenate([all_round, *images]), np.tile(copies, 3)
    right = twin(all_round, waving(all_round, load), copies, 0.35, np.ones(3), False, points)
    found = halo_flux(field, ratio=7.0, walls="mirror")
    assert_allclose(found, right, atol=1e-12)  # rounding of fluxes of up to 10
    clipped = twin(points, waving(points, load), volumes, 0.35, np.ones(3), False, points)
    assert_allclose(halo_flux(field, ratio=7.0), clipped, atol=1e-12)
    assert abs(clipped - right).max() > 1.0
    corner = np.array([[0.0, 1.0, 1.0]])
    where = twin(all_round, waving(all_round, load), copies, 0.35, np.ones(3), False, corner)
    assert_allclose(halo_flux(field, ratio=7.0, walls="mirror", at=corner), where, atol=1e-12)
    # At the very wall what is odd there cancels.
    expected = {0: 0.0, 2: 0.0} | ({} if load is None else {1: -load})
    assert_allclose(where[0, list(expected)], list(expected.values()), atol=1e-12)


def test_halos_of_a_periodic_cell():
    scene = Scene(size=SIZE, matrix=Material(1.0), gradient=(0, 1, 0))
    points, flux, volumes = cloud()
    field = made(scene, points, volumes, flux)
    right = twin(points, flux, volumes, 0.2, SIZE, True, points)
    for walls in ("clip", "mirror"):  # no wall, no mirror
        assert_allclose(halo_flux(field, ratio=4.0, walls=walls), right, atol=1e-13)  # rounding
    with pytest.raises(ValueError, match="radius = 0.45 m"):
        halo_flux(field, ratio=9.0)


def test_halos_within_one_phase():
    layer = Layer(0, 0.3, 0.6, Material(2.0))
    scene = Scene(size=(1, 1, 1), matrix=Material(1.0), inclusions=[layer], walls={"y-": 0.0, "y+": 1.0})
    points = np.random.default_rng(0).random((500, 3))
    phase = scene.phase_at(points)
    field = made(scene, points, np.ones(500), np.where(phase == 1, 2.0, 1.0)[:, None] * [0.0, -1.0, 0.0])
    own = halo_flux(field, ratio=4.0, same_phase=True)
    assert_allclose(own, field.samples.flux, rtol=1e-14)  # rounding of two sums of the same numbers
    at = np.array([[0.29, 0.5, 0.5], [0.31, 0.5, 0.5], [0.61, 0.5, 0.5]])
    assert_allclose(halo_flux(field, ratio=4.0, same_phase=True, at=at)[:, 1], [-1.0, -2.0, -1.0], rtol=1e-14)
    mixed = -halo_flux(field, ratio=4.0, at=at)[:, 1]
    assert np.all((mixed > 1.1) & (mixed < 1.9))
    mirrored = halo_flux(field, ratio=4.0, same_phase=True, walls="mirror", at=at)
    assert_allclose(mirrored[:, 1], [-1.0, -2.0, -1.0], rtol=1e-14)


def test_round_bodies_have_no_mirrors():
    scene = Scene(size=(1, 1, 1), matrix=Material(1.0, 1.0, 1.0), domain="sphere", walls={"round": 0.0}, initial=1.0)
    points = 0.5 + np.random.default_rng(0).uniform(-0.25, 0.25, (50, 3))
    field = made(scene, points, np.ones(50), np.ones((50, 3)))
    with pytest.raises(NotImplementedError, match="mirror"):
        halo_flux(field, ratio=4.0, walls="mirror")
    assert_allclose(halo_flux(field, ratio=4.0), 1.0, rtol=1e-14)
    with pytest.raises(ValueError, match="outside the sphere"):
        halo_flux(field, at=[0.05, 0.05, 0.5])


# ---- Flux of particles -----------------------------------------------------------------------------------------------


def solved(packing, scene, law):
    """Network and solution of a law."""
    if law == "calibrated":
        flat = calibration_scene(scene)
        unit = network_of(flat, packing, Calibrated(gap=0.07, factor=1.0))
        made = Calibrated(gap=0.07, factor=calibration(unit, flat, tolerance=1e-12))
    else:
        made = Laguerre(conforming=False)
    network = network_of(scene, packing, made)
    return network, solve_steady(network, scene, tolerance=1e-12)


def crystal(periodic, edge=6):
    x = np.stack(np.meshgrid(*[np.arange(edge) + 0.5] * 3, indexing="ij"), -1).reshape(-1, 3) / edge
    return make_packing(x, np.full(len(x), 0.5 / edge), (1, 1, 1), periodic, {})


@pytest.mark.parametrize("split", SPLITS)
@pytest.mark.parametrize("law", ["laguerre", "calibrated"])
def test_simple_cubic_crystal_is_exact(split, law):
    scene = Scene(size=(1, 1, 1), matrix=Material(3.0), gradient=(1.0, -2.0, 0.5))
    parts = solved(crystal(True), scene, law)
    # Rounding, of coordinates in links of a sixth; C_t has the tolerance of its solve besides.
    assert_allclose(particle_flux(*parts, split=split), np.tile([-3.0, 6.0, -1.5], (216, 1)), atol=1e-10)


def test_cells_at_walls_count_their_walls():
    scene = Scene(size=(1, 1, 1), matrix=Material(3.0), walls={"y-": 0.0, "y+": 2.0})
    parts = solved(crystal(False), scene, "laguerre")
    assert_allclose(particle_flux(*parts, split="cell"), np.tile([0.0, -6.0, 0.0], (216, 1)), atol=1e-10)
    half = particle_flux(*parts, split="half")
    y = parts[0].centers[:, 1]
    ends = (y < 0.1) | (y > 0.9)
    # The printed sum lacks the half of a cell at a wall that no link crosses.
    assert_allclose(half[ends, 1], -3.0, atol=1e-10)
    assert_allclose(half[~ends, 1], -6.0, atol=1e-10)
    # On any packing the cells together have the whole flux across the walls: between two cells it does not matter
    # where on their facet the heat passes, and at a wall not for the component across it.
    packing = relaxed(300, periodic=False, seed=0)
    parts = solved(packing, scene, "laguerre")
    mean = parts[0].volumes @ particle_flux(*parts, split="cell")
    assert_allclose(mean[1], -6.0, atol=1e-9)  # the solver's 1e-12 on each of 300 balances


@pytest.mark.parametrize("law", ["laguerre", "calibrated"])
def test_every_split_conserves_the_flux_of_a_periodic_cell(law):
    ball = [Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0))]
    scene = Scene(size=(1, 1, 1), matrix=Material(3.0), inclusions=ball, gradient=(0.3, 1.0, 0.0))
    parts = solved(relaxed(500, seed=0), scene, law)
    network, solution = parts
    here, there = row_numbers(network.indptr), network.indices
    step = branches(network.centers, network.size, network.indptr, network.indices, network.image)
    heat = network.conductance * (
        solution.temperature[there] - solution.temperature[here] + step @ solution.mean_gradient
    )
    first = -0.5 * heat @ step
    shares = {
        "half": np.full(len(here), 0.5),
        "radii": network.radii[here] / (network.radii[here] + network.radii[there]),
        "cell": link_distances(network) / np.linalg.norm(step, axis=1),
    }
    for split, share in shares.items():
        found = particle_flux(*parts, split=split)
        right = np.zeros((len(network.volumes), 3))
        np.add.at(right, here, -(share * heat)[:, None] * step)
        # Rounding; fluxes are of order 10.
        assert_allclose(found, right / network.volumes[:, None], atol=1e-11)
        assert_allclose(network.volumes @ found, first, atol=1e-12)
    field = field_of(scene, *parts, stats={})
    assert_allclose(first, field.mean_flux, atol=1e-12)
    assert_array_equal(particle_flux(*parts), cell_fluxes(network._replace(cells=False), solution))
    # Contacts part a link by the radii: the two are one there, and not for radical facets.
    off = abs(particle_flux(*parts, split="cell") - particle_flux(*parts, split="radii")).max()
    assert off < 1e-12 if law == "calibrated" else off > 0.1


def test_bad_split_and_arrays_of_another_packing():
    scene = Scene(size=(1, 1, 1), matrix=Material(3.0), gradient=(1.0, 0.0, 0.0))
    network, solution = solved(crystal(True), scene, "laguerre")
    other, _ = solved(crystal(True, 5), scene, "laguerre")
    with pytest.raises(ValueError, match="split = 'third'"):
        particle_flux(network, solution, split="third")
    with pytest.raises(ValueError, match="same particles"):
        particle_flux(other, solution)


def test_a_long_thin_box_takes_no_more_cells_than_samples():
    """Its volume per sample asks for some 1e9 cells along it."""
    rng = np.random.default_rng(4)
    points, values = rng.random((1000, 3)) * [1e12, 1.0, 1.0], rng.random(1000)
    means = halo_average(points, values, np.ones(1000), radius=0.4, size=(1e12, 1.0, 1.0), periodic=True)
    # Each lies alone in its halo.
    np.testing.assert_array_equal(means, values)


def test_no_halo_without_particles_or_outside_of_walls():
    field = exact.solve(Scene(size=(1, 1, 1), matrix=Material(1.0), walls={"y-": 0.0, "y+": 1.0}))
    with pytest.raises(ValueError, match="mean_radius"):
        halo_flux(field)
    with pytest.raises(ValueError, match=r"at\[0\] = .*: lies outside the box with walls"):
        halo_flux(replace(field, stats={"mean_radius": 0.05}), at=[[0.5, 1.5, 0.5]])
