import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat.scene import Flux, Layer, Material, Scene, Sphere
from references import exact, fft, fft_cg_kernels, fft_eyre_milton_kernels, fft_link_kernels, voxel_links
from references.voxels import medium, voxelise

SCHEMES = ("cg", "eyre-milton")
RULES = [("cg", "plain"), ("cg", "laminate"), ("cg", "links"), ("eyre-milton", "plain"), ("eyre-milton", "laminate")]
# Radius a third of the edge, k / k_m of the simple cubic array, from Rayleigh's multipole method (all digits right).
EXACT = {0.01: 0.786847280, 0.1: 0.812845293, 10.0: 1.395734838, 100.0: 1.533386809, 1e6: 1.552615028}


def sphere_cell(contrast, *, axis=0, center=(0.5, 0.5, 0.5), walls=False, matrix=1.0, size=1.0):
    load = {"walls": {"xyz"[axis] + "-": 20.0, "xyz"[axis] + "+": 30.0}} if walls else {"gradient": np.eye(3)[axis]}
    sphere = Sphere([size * c for c in center], size / 3, Material(matrix * contrast))
    return Scene((size,) * 3, Material(matrix), [sphere], **load)


def dispersion(gradient=None, walls=None):
    """A shell with a core, a poor and a good sphere, two of them across faces; no symmetry at all."""
    good, poor = Material(8.0), Material(0.3)
    spheres = [
        Sphere((0.31, 0.42, 0.55), 0.26, good),
        Sphere((0.33, 0.40, 0.52), 0.15, poor),
        Sphere((0.80, 0.95, 0.12), 0.18, poor),
        Sphere((0.77, 0.61, 0.70), 0.17, good),
    ]
    return Scene((1.0, 1.2, 0.9), Material(1.0), spheres, gradient=gradient, walls=walls)


# Closed forms


@pytest.mark.parametrize(("scheme", "rule"), RULES)
@pytest.mark.parametrize("load", [{"gradient": (3.0, -1.0, 2.0)}, {"walls": {"y-": 300.0, "y+": 280.0}}])
def test_a_homogeneous_box_is_exact(scheme, rule, load):
    scene = Scene((2.0, 1.0, 0.5), Material(4.0), **load)
    field = fft.solve(scene, voxels=(3, 5, 4), scheme=scheme, rule=rule)
    slope = np.array(load.get("gradient", (0.0, -20.0, 0.0)))
    # Rounding only: there is nothing to iterate on.
    assert_allclose(field.mean_flux, -4 * slope, rtol=1e-12, atol=1e-12)
    points = np.random.default_rng(0).random((50, 3)) * scene.size
    assert_allclose(field.temperature_at(points), (0 if scene.periodic else 300) + points @ slope, rtol=1e-12)
    assert_allclose(field.flux_at(points), np.tile(-4 * slope, (50, 1)), rtol=1e-12, atol=1e-12)
    assert_allclose(field.conductivity, 4.0, rtol=1e-12)


@pytest.mark.parametrize(("scheme", "rule"), [r for r in RULES if r[1] != "plain"])
@pytest.mark.parametrize("voxels", [(3, 8, 2), (2, 7, 3)])
@pytest.mark.parametrize("walls", [False, True])
def test_a_laminate_across_the_load_is_exact_anywhere(scheme, rule, voxels, walls):
    layers = [Layer(1, 0.13, 0.5, Material(50.0)), Layer(1, 0.5, 0.77, Material(0.1))]
    load = {"walls": {"y-": 1.0, "y+": 0.0}} if walls else {"gradient": (0.0, -1.0, 0.0)}
    field = fft.solve(Scene((1, 1, 1), Material(2.0), layers, **load), voxels=voxels, scheme=scheme, rule=rule)
    expected = 1 / (0.36 / 2 + 0.37 / 50 + 0.27 / 0.1)
    # The conductivity's error is second order in the solver's 1e-5 (cg), first order in its 1e-6 (eyre-milton).
    assert_allclose(field.conductivity, expected, rtol=1e-6)
    assert_allclose(field.mean_flux[[0, 2]], 0, atol=1e-9)  # Rounding of iterates, conductivities up to 50.


@pytest.mark.parametrize(("scheme", "rule"), RULES)
@pytest.mark.parametrize("walls", [False, True])
def test_a_laminate_along_the_load_is_exact(scheme, rule, walls):
    # Laminates take interfaces anywhere; plain voxels and links want them between two nodes.
    ends = (0.13, 0.41, 0.8) if rule == "laminate" else (0.125, 0.375, 0.875)
    layers = [Layer(2, *ends[:2], Material(50.0)), Layer(2, *ends[1:], Material(0.1))]
    load = {"walls": {"x-": 1.0, "x+": 0.0}} if walls else {"gradient": (-1.0, 0.0, 0.0)}
    field = fft.solve(Scene((1, 1, 1), Material(2.0), layers, **load), voxels=(2, 3, 8), scheme=scheme, rule=rule)
    good, poor = ends[1] - ends[0], ends[2] - ends[1]
    # cg starts from the exact gradient; eyre-milton's p iterates to its tolerance of 1e-6.
    assert_allclose(field.conductivity, 2 * (1 - good - poor) + 50 * good + 0.1 * poor, rtol=1e-6)
    # Halves of one voxel count as they are.
    assert_allclose(field.fractions, [1 - good - poor, good, poor], atol=1e-12)


@pytest.mark.parametrize(
    ("scheme", "rule", "contrast", "percent"),
    # Errors found at 32^3, in percent; a limit is a quarter above, on that side only.
    [
        ("cg", "laminate", 0.01, -0.157),
        ("cg", "laminate", 0.1, -0.0241),
        ("cg", "laminate", 10.0, 0.0634),
        ("cg", "links", 100.0, -0.120),
        ("cg", "links", 1e6, -0.065),
        ("cg", "plain", 10.0, 0.494),
        ("eyre-milton", "laminate", 0.01, -0.170),
        ("eyre-milton", "laminate", 0.1, -0.0318),
        ("eyre-milton", "laminate", 10.0, 0.0645),
        ("eyre-milton", "laminate", 100.0, 0.486),
    ],
)
def test_a_sphere_against_rayleigh(scheme, rule, contrast, percent):
    field = fft.solve(sphere_cell(contrast), voxels=32, scheme=scheme, rule=rule)
    error = 100 * (field.conductivity / EXACT[contrast] - 1)
    assert 0 < error / percent < 1.25


def test_the_automatic_rule_is_the_measured_best():
    def chosen(*contrasts, scheme="cg"):
        spheres = [Sphere((0.2 + 0.3 * i, 0.5, 0.5), 0.1, Material(c)) for i, c in enumerate(contrasts)]
        scene = Scene((1, 1, 1), Material(1.0), spheres, gradient=(1.0, 0.0, 0.0))
        return fft.solve(scene, voxels=4, scheme=scheme, max_iterations=500).stats["rule"]

    assert [chosen(c) for c in (0.0, 1e-5, 0.01, 1.0, 10.0, 100.0, 1e6)] == [
        "plain", "plain", "laminate", "laminate", "laminate", "links", "links"
    ]  # fmt: skip
    assert chosen(10.0, 100.0) == "links"
    assert chosen(0.1, 10.0) == "laminate"
    assert chosen(100.0, scheme="eyre-milton") == "laminate"
    layers = Scene((1, 1, 1), Material(1.0), [Layer(0, 0.0, 0.4, Material(1e5))], gradient=(1.0, 0.0, 0.0))
    assert fft.solve(layers, voxels=4).stats["rule"] == "laminate"


@pytest.mark.parametrize(("scheme", "rule"), [r for r in RULES if r[1] != "plain"])
@pytest.mark.parametrize("axis", [0, 2])
def test_the_field_of_a_sphere_between_walls(scheme, rule, axis):
    scene = sphere_cell(5.0, axis=axis, walls=True, matrix=33.0, size=0.1)
    field, closed = fft.solve(scene, voxels=32, scheme=scheme, rule=rule), exact.solve(scene)
    points = np.random.default_rng(1).random((2000, 3)) * 0.1
    temperature = field.temperature_at(points) - closed.temperature_at(points)
    flux = field.flux_at(points) - closed.flux_at(points)
    # Root mean squares over the span and the mean flux; found 0.5e-3 to 0.7e-3 and 0.028 to 0.030, first order in the
    # voxel.  Trilinear interpolation across the interface makes them 1e-3, the nearest voxel 0.09.
    assert np.sqrt(np.mean(temperature**2)) / 10 < 0.8e-3
    assert np.sqrt(np.mean(np.sum(flux**2, axis=1))) / np.linalg.norm(closed.mean_flux) < 0.035
    samples = field.samples
    assert_allclose(samples.volumes.sum(), scene.volume, rtol=1e-12)
    # A sample is the field at its own point.
    assert_allclose(field.temperature_at(samples.points[::99]), samples.temperature[::99], rtol=1e-12)
    assert_allclose(field.flux_at(samples.points[::99]), samples.flux[::99], rtol=1e-9)
    assert_allclose((samples.flux * samples.volumes[:, None]).sum(axis=0) / scene.volume, field.mean_flux, atol=1e-6)
    assert np.array_equal(samples.phase, scene.phase_at(samples.points))


# The two schemes, and boxes with walls


@pytest.mark.parametrize("contrast", [0.1, 10.0])
def test_the_schemes_approach_each_other(contrast):
    cells = [fft.solve(sphere_cell(contrast), voxels=n, scheme=s).conductivity for n in (16, 48) for s in SCHEMES]
    # Both errors are below 1.3 % / n^1.3 there, with the same sign.
    assert_allclose(cells[0], cells[1], rtol=6e-4)
    assert_allclose(cells[2], cells[3], rtol=1.5e-4)


@pytest.mark.parametrize(("scheme", "rule"), RULES)
@pytest.mark.parametrize("voxels", [12, 13, (12, 13, 14)])
def test_a_symmetric_box_with_walls_equals_the_periodic_cell(scheme, rule, voxels):
    periodic, walls = (
        fft.solve(sphere_cell(20.0, axis=1, walls=w), voxels=voxels, scheme=scheme, rule=rule, tolerance=1e-9)
        for w in (False, True)
    )
    # Solver tolerance; the voxels are as symmetric as the scene.
    assert_allclose(walls.conductivity, periodic.conductivity, rtol=1e-8)


@pytest.mark.parametrize(("scheme", "rule"), RULES)
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_any_box_with_walls_equals_its_mirrored_periodic_cell(scheme, rule, axis):
    name = "xyz"[axis]
    box = dispersion(walls={name + "-": 3.0, name + "+": 1.0})
    mirrored = [
        replace(s, center=np.where(sides, 2 * np.array(box.size) - s.center, s.center))
        for s in box.inclusions
        for sides in itertools.product((False, True), repeat=3)
    ]
    size = tuple(2 * length for length in box.size)
    whole = Scene(size, box.matrix, _inside(mirrored), gradient=np.eye(3)[axis])
    box = replace(box, inclusions=_inside(box.inclusions))
    knobs = {"scheme": scheme, "rule": rule, "tolerance": 1e-9}
    walls = fft.solve(box, voxels=(7, 8, 6), **knobs)
    periodic = fft.solve(whole, voxels=(14, 16, 12), **knobs)
    # The same discrete problem, up to rounding in the voxels' fractions; both solved to 1e-9.
    assert_allclose(walls.conductivity, periodic.conductivity, rtol=1e-8)
    points = np.random.default_rng(2).random((100, 3)) * box.size
    slope = 2.0 / box.size[axis]
    expected = 3 - slope * periodic.temperature_at(points)
    shift = np.mean(expected - walls.temperature_at(points))
    # The gradient of a periodic cell leaves the level open, a mirrored one has it at the wall.
    assert abs(shift) < 1e-6
    assert_allclose(walls.temperature_at(points), expected, atol=1e-6)
    assert_allclose(walls.flux_at(points), -slope * periodic.flux_at(points), atol=2e-6 * np.abs(walls.mean_flux).max())


def _inside(spheres):
    """Spheres that no wall cuts: mirroring the others would make them overlap their images."""
    return [s for s in spheres if s.radius != 0.18]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_walls_have_their_temperatures_and_heat_balances(scheme):
    scene = dispersion(walls={"z-": 25.0, "z+": 35.0})
    field = fft.solve(scene, voxels=16, scheme=scheme)
    rng = np.random.default_rng(0)
    for name, height in (("z-", 0.0), ("z+", 0.9)):
        wall = rng.random((40, 3)) * scene.size
        wall[:, 2] = height
        # Mirrored neighbours cancel exactly.
        assert_allclose(field.temperature_at(wall), scene.walls[name], rtol=1e-12)
        # No heat leaves sideways along an isothermal wall, nor through an insulated one.
        assert_allclose(field.flux_at(wall)[:, :2], 0, atol=1e-9)
    side = rng.random((40, 3)) * scene.size
    side[:, 1] = 1.2
    assert_allclose(field.flux_at(side)[:, 1], 0, atol=1e-9)
    assert field.wall_temperature == {"z-": 25.0, "z+": 35.0}
    assert field.wall_heat["z-"] < 0 < field.wall_heat["z+"]
    # The equilibrium error is below 1e-5 of the flux.
    assert_allclose(field.wall_heat["z+"], -field.mean_flux[2] * 1.2, rtol=1e-5)
    assert_allclose(sum(field.wall_heat.values()), 0, atol=1e-5 * field.wall_heat["z+"])


# Symmetries


@pytest.mark.parametrize("scheme", SCHEMES)
def test_reversing_and_scaling(scheme):
    scene = dispersion(gradient=(1.0, 2.0, -1.0))
    field = fft.solve(scene, voxels=12, scheme=scheme)
    back = fft.solve(replace(scene, gradient=(-1.0, -2.0, 1.0)), voxels=12, scheme=scheme)
    # The iteration is linear in the load.
    assert_allclose(back.mean_flux, -field.mean_flux, rtol=1e-12)
    small = Scene(
        tuple(1e-6 * a for a in scene.size),
        Material(1e-3),
        [Sphere([1e-6 * c for c in s.center], 1e-6 * s.radius, Material(1e-3 * s.material.conductivity))
         for s in scene.inclusions],
        gradient=(1e8, 2e8, -1e8),
    )  # fmt: skip
    scaled = fft.solve(small, voxels=12, scheme=scheme)
    # Scaled coordinates round differently, and so do the cut voxels.
    assert_allclose(scaled.mean_flux, 1e5 * field.mean_flux, rtol=1e-9)
    points = np.random.default_rng(0).random((30, 3)) * scene.size
    assert_allclose(scaled.temperature_at(1e-6 * points), 100 * field.temperature_at(points), rtol=1e-8, atol=1e-7)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("walls", [False, True])
def test_rotating_the_scene_rotates_the_solution(scheme, walls):
    turn = [2, 0, 1]
    scene = dispersion(walls={"x-": 0.0, "x+": 1.0}) if walls else dispersion(gradient=(1.0, 0.5, 0.0))
    turned = Scene(
        np.array(scene.size)[turn],
        scene.matrix,
        [replace(s, center=np.array(s.center)[turn]) for s in scene.inclusions],
        gradient=None if walls else np.array(scene.gradient)[turn],
        walls={"y-": 0.0, "y+": 1.0} if walls else None,
    )
    knobs = {"scheme": scheme, "tolerance": 1e-9}
    field = fft.solve(scene, voxels=(10, 12, 9), **knobs)
    rotated = fft.solve(turned, voxels=(9, 10, 12), **knobs)
    # Solver tolerance; the last axis is transformed another way.
    assert_allclose(rotated.mean_flux, field.mean_flux[turn], rtol=1e-7, atol=1e-8)
    points = np.random.default_rng(0).random((50, 3)) * scene.size
    assert_allclose(rotated.temperature_at(points[:, turn]), field.temperature_at(points), atol=1e-6)
    assert_allclose(rotated.flux_at(points[:, turn]), field.flux_at(points)[:, turn], atol=1e-5)
    assert_allclose(rotated.fractions, field.fractions, rtol=1e-12)


@pytest.mark.parametrize(("scheme", "rule"), RULES)
def test_the_conductivity_tensor_is_symmetric_and_within_its_bounds(scheme, rule):
    fields = [fft.solve(dispersion(gradient=g), voxels=11, scheme=scheme, rule=rule, tolerance=1e-8) for g in np.eye(3)]
    tensor = -np.array([f.mean_flux for f in fields])
    assert_allclose(tensor, tensor.T, atol=1e-7)  # Solver tolerance.
    assert np.abs(tensor - np.diag(np.diag(tensor))).max() > 1e-3
    fractions, conductivity = fields[0].fractions, dispersion(gradient=(1, 0, 0)).conductivities
    eigenvalues = np.linalg.eigvalsh(0.5 * (tensor + tensor.T))
    # Links see other fractions than plain voxels do: 2 % covers the difference on this grid.
    assert eigenvalues.max() < 1.02 * fractions @ conductivity
    assert eigenvalues.min() > 0.98 / (fractions @ (1 / conductivity))


# Grids, precision, extremes


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("walls", [False, True])
@pytest.mark.parametrize("voxels", [1, 2, 3, 5, (1, 4, 7), (2, 1, 1), (9, 2, 3)])
def test_tiny_and_odd_grids(scheme, walls, voxels):
    scene = dispersion(walls={"x-": 0.0, "x+": 1.0}) if walls else dispersion(gradient=(1.0, 0.0, 0.0))
    nx = np.atleast_1d(voxels)[0]
    if scheme == "cg" and walls and nx == 1:
        with pytest.raises(ValueError, match="voxels"):
            fft.solve(scene, voxels=voxels, scheme=scheme, rule="laminate")
        return
    field = fft.solve(scene, voxels=voxels, scheme=scheme, rule="laminate")
    # Whatever the grid, a mean over parts of it stays within the extremes of its phases.
    assert 0.3 < field.conductivity < 8.0
    assert field.stats["residual"] < 1e-5
    assert np.all(np.isfinite(field.samples.temperature))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("walls", [False, True])
def test_single_precision(scheme, walls):
    scene = dispersion(walls={"x-": 0.0, "x+": 1.0}) if walls else dispersion(gradient=(1.0, 0.0, 0.0))
    single, double = (
        fft.solve(scene, voxels=15, scheme=scheme, precision=p, max_iterations=200) for p in ("float32", "float64")
    )
    # Rounding of 6e-8 a number, summed in float64.
    assert_allclose(single.mean_flux, double.mean_flux, rtol=2e-6, atol=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_threads_do_not_change_the_answer(scheme):
    scene = dispersion(gradient=(1.0, 0.0, 0.0))
    one, two, all_ = (fft.solve(scene, voxels=9, scheme=scheme, threads=t).mean_flux for t in (1, 2, None))
    # FFTW may plan another order of sums.
    assert_allclose(two, one, rtol=1e-12, atol=1e-14)
    assert_allclose(all_, one, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("rule", ["plain", "links"])
def test_a_contrast_of_a_million_converges_to_its_own_limit(rule):
    loose, tight = (
        fft.solve(sphere_cell(1e6, center=(0.51, 0.47, 0.53)), voxels=16, rule=rule, tolerance=t).conductivity
        for t in (None, 1e-9)
    )
    # What the default tolerance promises.  A first trial that looked at the energy alone stopped 2e-4 away.
    assert_allclose(loose, tight, rtol=1e-6)


def test_surfaces_kept_off_the_nodes_save_iterations(monkeypatch):
    scene = sphere_cell(1e4, center=(0.513, 0.471, 0.537))
    kept = fft.solve(scene, voxels=24, rule="links")
    monkeypatch.setattr(voxel_links, "NEAREST", 0.0)
    exactly = fft.solve(scene, voxels=24, rule="links")
    # Found 165 and 188 iterations (half at 64^3), and a conductivity lower by 1.1e-5, a hundredth of its error.
    assert kept.stats["iterations"] < 0.95 * exactly.stats["iterations"]
    assert 0 < exactly.conductivity / kept.conductivity - 1 < 2e-5


def test_pores():
    scene = Scene((1, 1, 1), Material(2.0), [Sphere((0.5,) * 3, 1 / 3, Material(0.0))], gradient=(0.0, 0.0, 1.0))
    field = fft.solve(scene, voxels=32)
    # Plain voxels: twice the 0.29 % found.
    assert_allclose(field.conductivity, exact.solve(scene).conductivity, rtol=6e-3)
    assert np.all(np.isfinite(field.samples.temperature))
    inside = np.linalg.norm(field.samples.points - 0.5, axis=1) < 0.28
    assert np.all(field.samples.flux[inside] == 0)
    with pytest.raises(NotImplementedError, match="conductivity is 0"):
        fft.solve(scene, voxels=4, scheme="eyre-milton")
    with pytest.raises(NotImplementedError, match="conductivity is 0"):
        fft.solve(scene, voxels=4, rule="links")


def test_a_body_without_conductivity_conducts_nothing():
    field = fft.solve(Scene((1, 1, 1), Material(0.0), gradient=(1.0, 0.0, 0.0)), voxels=4)
    assert np.array_equal(field.mean_flux, [0, 0, 0])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_equal_walls_carry_no_heat(scheme):
    field = fft.solve(dispersion(walls={"x-": 7.0, "x+": 7.0}), voxels=6, scheme=scheme)
    assert_allclose(field.mean_flux, 0, atol=0)
    assert_allclose(field.samples.temperature, 7.0, rtol=1e-15)


# Convergence is never pretended


@pytest.mark.parametrize(("scheme", "rule"), RULES)
@pytest.mark.parametrize("walls", [False, True])
def test_too_few_iterations_raise(scheme, rule, walls):
    with pytest.raises(RuntimeError, match=r"3 iterations, relative residual \d"):
        fft.solve(sphere_cell(30.0, walls=walls), voxels=8, scheme=scheme, rule=rule, max_iterations=3)


# cg waits for two small decreases of the energy: two iterations more than its final check asks for.
@pytest.mark.parametrize(("scheme", "less"), [("cg", 3), ("eyre-milton", 1)])
def test_just_too_few_iterations_raise(scheme, less):
    needed = fft.solve(sphere_cell(30.0), voxels=8, scheme=scheme).stats["iterations"] - less
    with pytest.raises(RuntimeError, match=f"{needed} iterations"):
        fft.solve(sphere_cell(30.0), voxels=8, scheme=scheme, max_iterations=needed)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_rounding_forbids_raises(scheme):
    with pytest.raises(RuntimeError, match="did not converge"):
        fft.solve(sphere_cell(30.0), voxels=8, scheme=scheme, precision="float32", tolerance=1e-9, max_iterations=300)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_follows_the_tolerance(scheme):
    solved = [fft.solve(dispersion(gradient=(1.0, 0, 0)), voxels=12, scheme=scheme, tolerance=t) for t in (1e-3, 1e-10)]
    assert solved[0].stats["residual"] < 1e-3 * (1 if scheme == "cg" else 10) and solved[1].stats["residual"] < 1e-9
    assert solved[0].stats["iterations"] < solved[1].stats["iterations"]
    assert 0 < abs(solved[0].conductivity / solved[1].conductivity - 1) < 1e-3
    for name in ("unknowns", "iterations", "residual", "scheme", "rule", "voxels", "precision"):
        assert name in solved[0].stats


# Kernels against slow twins


def _random_medium(shape):
    scene = dispersion(gradient=(1.0, 0.0, 0.0))
    grid = voxelise(scene, shape, laminate=True)
    full = np.zeros((*shape, 3, 3))
    full[:] = grid.conductivity[grid.phase][..., None, None] * np.eye(3)
    full.reshape(-1, 3, 3)[grid.cut] = grid.tensor[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
    return grid, full


def _corner_operator(shape, spacing, walls):
    """Matrices of the gradient in each voxel from the temperatures at its corners, by the definition."""
    nodes = (shape[0] - 1, shape[1] + 1, shape[2] + 1) if walls else shape
    matrix = np.zeros((*shape, 3, *nodes))
    for voxel in np.ndindex(*shape):
        for corner in itertools.product((0, 1), repeat=3):
            node = [v + c for v, c in zip(voxel, corner, strict=True)]
            if walls:
                node[0] -= 1
                if not 0 <= node[0] < nodes[0]:
                    continue
            else:
                node = [n % m for n, m in zip(node, shape, strict=True)]
            for axis in range(3):
                matrix[(*voxel, axis, *node)] += (2 * corner[axis] - 1) / (4 * spacing[axis])
    return matrix


@pytest.mark.parametrize("walls", [False, True])
def test_conduction_through_voxels_against_its_definition(walls):
    shape = (4, 3, 5)
    grid, full = _random_medium(shape)
    matrix = _corner_operator(shape, grid.spacing, walls)
    theta = np.random.default_rng(0).random(matrix.shape[4:])
    load = np.array([0.3, -0.2, 0.5])
    slope = np.tensordot(matrix, theta, 3) + load
    flux = np.einsum("xyzab,xyzb->xyza", full, slope)
    work, sums = np.full((*theta.shape[:2], theta.shape[2] + 2), np.nan), np.zeros((4, 5))
    kernel_medium = medium(grid, grid.conductivity, grid.tensor, float)
    for low, high in ((0, 1), (1, len(theta))):  # In two chunks.
        fft_cg_kernels.conduct_voxels(theta, work, kernel_medium, load, 0.25 / grid.spacing, walls, sums, low, high)
    assert_allclose(work[..., : theta.shape[2]], np.tensordot(flux, matrix, 4), atol=1e-12)
    expected = [np.sum(flux * slope), *flux.sum(axis=(0, 1, 2)), np.sum(flux**2)]
    assert_allclose(sums.sum(axis=0), expected, rtol=1e-12)


@pytest.mark.parametrize("walls", [False, True])
def test_conduction_through_links_against_its_definition(walls):
    shape, spacing = (3, 4, 2), np.array([0.3, 0.2, 0.5])
    rng = np.random.default_rng(1)
    conductivity = [rng.random(tuple(np.array(shape) + np.eye(3, dtype=int)[a])) for a in range(3)]
    for axis, link in enumerate(conductivity):
        ends = np.moveaxis(link, axis, 0)
        ends[-1] = ends[0]
        if walls and axis:
            ends[[0, -1]] = 0
    theta, load = rng.random(shape), np.array([0.3, -0.2, 0.5])
    expected, energy = np.zeros(shape), 0.0
    for axis in range(3):
        for index in np.ndindex(*conductivity[axis].shape):
            above, below = list(index), list(index)
            below[axis] -= 1
            signs, weight = [1.0, 1.0], 0.5 if index[axis] in (0, shape[axis]) else 1.0
            if walls and axis == 0:  # Mirrored in the wall, sign changed.
                signs = [-1.0 if index[0] == shape[0] else 1.0, -1.0 if index[0] == 0 else 1.0]
                above[0], below[0] = min(above[0], shape[0] - 1), max(below[0], 0)
            above[axis] %= shape[axis]
            slope = (signs[0] * theta[tuple(above)] - signs[1] * theta[tuple(below)]) / spacing[axis] + load[axis]
            flux = conductivity[axis][index] * slope
            energy += weight * flux * slope
            if index[axis] < shape[axis]:
                expected[tuple(above)] += flux / spacing[axis]
            if index[axis] > 0:
                expected[tuple(below)] -= flux / spacing[axis]
    work, sums = np.full((*shape[:2], 4), np.nan), np.zeros((3, 5))
    links = fft_link_kernels.Links(*conductivity)
    fft_link_kernels.conduct_links(theta, work, links, load, 1 / spacing, walls, sums, 0, 3)
    assert_allclose(work[..., :2], expected, atol=1e-12)
    assert_allclose(sums[:, 0].sum(), energy, rtol=1e-12)


def test_the_reflection_in_fourier_space_against_its_definition():
    shape, rng = (4, 3, 6), np.random.default_rng(0)
    field, mean = rng.random((3, *shape)), np.array([0.1, 0.2, 0.3])
    numbers = [2 * np.pi * n * np.fft.fftfreq(n) for n in shape]
    modes = np.fft.fftn(field, axes=(1, 2, 3))
    for index in np.ndindex(*shape):
        nyquist = [2 * i == n for i, n in zip(index, shape, strict=True)]
        k = np.array([0.0 if f else x[i] for f, x, i in zip(nyquist, numbers, index, strict=True)])
        gamma = np.diag(np.array(nyquist, float)) + (np.outer(k, k) / (k @ k) if k.any() else 0)
        modes[(slice(None), *index)] = (np.eye(3) - 2 * gamma) @ modes[(slice(None), *index)]
    expected = np.fft.ifftn(modes, axes=(1, 2, 3)) + mean[:, None, None, None]
    # A real field stays real: that is what the treatment of the Nyquist frequencies is for.
    assert_allclose(expected.imag, 0, atol=1e-14)
    half = np.fft.rfftn(field, axes=(1, 2, 3))
    wave = tuple(np.where(2 * np.arange(n) == n, 0, x) for n, x in zip(shape, numbers, strict=True))
    free = tuple((2 * np.arange(n) == n).astype(float) for n in shape)
    wave, free = (*wave[:2], np.abs(wave[2][:4])), (*free[:2], free[2][:4])
    fft_eyre_milton_kernels.reflect_modes(half, wave, free, 1 / 72, mean, 0, 4)
    assert_allclose(np.fft.irfftn(half * 72, s=shape, axes=(1, 2, 3)), expected.real, atol=1e-13)


# Bad input


@pytest.mark.parametrize(
    ("knobs", "message"),
    [
        ({"scheme": "basic"}, "scheme = 'basic'"),
        ({"rule": "voigt"}, "rule = 'voigt'"),
        ({"scheme": "eyre-milton", "rule": "links"}, "rule = 'links'"),
        ({"precision": "float16"}, "precision = 'float16'"),
        ({"threads": 0}, "threads = 0"),
        ({"threads": 1.5}, "threads = 1.5"),
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"tolerance": float("nan")}, "tolerance = nan"),
        ({"tolerance": "tight"}, "tolerance = 'tight'"),
        ({"max_iterations": 0}, "max_iterations = 0"),
        ({"max_iterations": 10.0}, "max_iterations = 10.0"),
        ({"voxels": 0}, "voxels = 0"),
        ({"voxels": 10**6}, "voxels = 1000000"),
    ],
)
def test_bad_knobs(knobs, message):
    with pytest.raises(ValueError, match=message):
        fft.solve(sphere_cell(10.0), **knobs)


@pytest.mark.parametrize(
    "walls",
    [{"x-": 1.0, "x+": Flux(2.0)}, {"x-": 1.0}, {"x-": 1.0, "y+": 2.0}, dict.fromkeys(("x-", "x+", "y-"), 1.0)],
)
def test_other_loads_are_refused(walls):
    with pytest.raises(NotImplementedError, match="two opposite walls"):
        fft.solve(Scene((1, 1, 1), Material(1.0), walls=walls), voxels=4)


def test_a_load_that_fixes_no_temperature_is_bad_input():
    with pytest.raises(ValueError, match="at least one wall with a temperature"):
        fft.solve(Scene((1, 1, 1), Material(1.0), walls={"x-": Flux(1.0), "x+": Flux(-1.0)}), voxels=4)


def test_bad_points():
    field = fft.solve(sphere_cell(10.0, walls=True), voxels=4)
    for ask in (field.temperature_at, field.flux_at):
        with pytest.raises(ValueError, match="finite"):
            ask([[0.1, np.nan, 0.2]])
        with pytest.raises(ValueError, match="1 lie outside the box"):
            ask([[0.1, 0.2, 0.2], [0.1, 1.2, 0.2]])


def test_plans_are_kept(tmp_path, monkeypatch):
    from references import fft_transforms

    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(fft_transforms, "MEASURED_FROM", 1)
    fft_transforms.fourier(1, (6, 10, 14), np.float64, 1)
    kept = tmp_path / "cache" / "fftw-wisdom-float64.txt"
    assert b"fftw_wisdom" in kept.read_bytes()
    fft_transforms.pyfftw.forget_wisdom()
    fft_transforms._loaded.clear()
    # With the kept wisdom alone the plan is there; without it FFTW would have to measure.
    monkeypatch.setattr(fft_transforms, "_save_wisdom", lambda dtype: pytest.fail("measured again"))
    fft_transforms.fourier(1, (6, 10, 14), np.float64, 1)
