"""Errors of a sphere rule by rule, which rule is chosen, and walls that are mirrors: signs of each transform."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from fft_scenes import EXACT, RULES, dispersion, sphere_cell
from numpy.testing import assert_allclose

from demheat.scene import Layer, Material, Scene, Sphere
from references import fft

# Grids here are coarse on purpose.
pytestmark = [
    pytest.mark.filterwarnings("ignore:inclusions .* are coats thinner than a voxel"),
    pytest.mark.filterwarnings("ignore:gaps beside inclusions"),
]

# Closed forms


@pytest.mark.parametrize(
    ("scheme", "rule", "contrast", "percent"),
    # Errors found at 32^3, in percent; a limit is a quarter above, on that side only.
    [
        ("cg", "laminate", 0.1, -0.0241),
        ("cg", "laminate", 10.0, 0.0634),
        ("cg", "links", 100.0, -0.120),
        ("cg", "plain", 10.0, 0.494),
        ("eyre-milton", "laminate", 0.01, -0.170),
        ("eyre-milton", "laminate", 10.0, 0.0645),
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
