"""Voxels and Fourier transforms: closed forms, boxes with walls against periodic cells, symmetries."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from fft_scenes import EXACT, RULES, SCHEMES, dispersion, sphere_cell
from numpy.testing import assert_allclose

from demheat.scene import Layer, Material, Scene, Sphere
from references import fft

# Grids here are coarse on purpose.
pytestmark = [
    pytest.mark.filterwarnings("ignore:inclusions .* are coats thinner than a voxel"),
    pytest.mark.filterwarnings("ignore:gaps beside inclusions"),
]

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
        return fft.solve(scene, voxels=6, scheme=scheme, max_iterations=500).stats["rule"]

    assert [chosen(c) for c in (0.0, 1e-5, 0.01, 1.0, 10.0, 100.0, 1e6)] == [
        "plain", "plain", "laminate", "laminate", "laminate", "links", "links"
    ]  # fmt: skip
    assert chosen(10.0, 100.0) == "links"
    assert chosen(0.1, 10.0) == "laminate"
    assert chosen(100.0, scheme="eyre-milton") == "laminate"
    layers = Scene((1, 1, 1), Material(1.0), [Layer(0, 0.0, 0.4, Material(1e5))], gradient=(1.0, 0.0, 0.0))
    assert fft.solve(layers, voxels=4).stats["rule"] == "laminate"


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
