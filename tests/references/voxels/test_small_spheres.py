"""Spheres about as small as voxels, through corners, faces and centres: volumes, parts that add up, no overrun."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat.scene import Material, Scene, Sphere
from references import fft
from references.voxels import kernels
from references.voxels.links import links
from references.voxels.paint import Cuts, voxelise

SIDES = (1, 2, 3, 4, 5, 7, 8, 9, 11, 13)
# Radii in voxels; 1/2, sqrt(1/2), sqrt(3/4), ... go through faces, edges and corners of voxels centred alike.
RADII = (0.1, 0.2, 0.25, 0.3, 0.5, 0.5**0.5, 0.75**0.5, 0.8, 0.86, 1.0, 2**0.5, 1.5, 3**0.5, 2.0)
# Part of a small sphere's volume by which the columns of quadrature may be wrong: found 0.94 % where they are as wide
# as the sphere (less than a voxel across), 2.2 % of spheres of one voxel across; a third more.
VOLUME = 0.03
OTHER = Material(10.0)

pytestmark = pytest.mark.filterwarnings("ignore:inclusions .* are smaller than a voxel")


def drawn(seed, sides=SIDES):
    """A grid and up to eight spheres in its voxels, some together in one, as its scene admits them."""
    rng = np.random.default_rng(seed)
    n = rng.choice(sides, 3) if seed % 2 else np.full(3, rng.choice(sides))
    spacing = 1 / n
    inclusions = []
    for _ in range(rng.choice([1, 2, 8])):
        beside = rng.choice([0.0, 1e-17, -1e-16, 1e-12, -1e-9], 3) * rng.integers(2)
        center = (rng.integers(0, n) + rng.choice([0.0, 0.25, 0.5, 1.0], 3) + beside) * spacing
        radius = min(rng.choice(RADII) * rng.choice([spacing.min(), spacing.max()]), 0.49)
        inclusions += admitted(inclusions, Sphere(tuple(center), radius, OTHER))
    return tuple(int(side) for side in n), cell(*inclusions)


def admitted(inclusions, sphere):
    try:
        cell(*inclusions, sphere)
    except ValueError:
        return []
    return [sphere]


def cell(*inclusions, walls=None):
    load = {"walls": walls} if walls else {"gradient": (1.0, 0.0, 0.0)}
    return Scene((1.0, 1.0, 1.0), Material(1.0), inclusions, **load)


@pytest.mark.parametrize("first", slow_but({0}, range(0, 200, 50)))
def test_volumes(first):
    for seed in range(first, first + 50):
        shape, scene = drawn(seed)
        plain, cut = (voxelise(scene, shape, laminate=laminate) for laminate in (False, True))
        for grid in (plain, cut):
            assert grid.fractions.min() >= 0
            assert_allclose(grid.fractions.sum(), 1.0, rtol=1e-13, err_msg=str(seed))  # Rounding.
        exact = np.array([4 / 3 * np.pi * sphere.radius**3 for sphere in scene.inclusions])
        own = np.array([volume_inside(sphere, scene.inclusions) for sphere in scene.inclusions])
        # A sphere that holds others has what they leave; errors are those of all of them.
        assert np.all(np.abs(cut.fractions[1:] - (exact - own)) <= VOLUME * (exact + own)), seed
        eigenvalues = np.linalg.eigvalsh(cut.tensor[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]])
        assert np.all((eigenvalues > 1 - 1e-12) & (eigenvalues < 10 + 1e-11)), seed  # Rounding.
        for link in links(scene, shape):
            assert np.all((link > 1 - 1e-12) & (link < 10 + 1e-11)), seed


def volume_inside(outer, spheres):
    """Of the spheres directly in another one, images included."""
    inside, found = [], 0.0
    for sphere in spheres:
        away = np.subtract(sphere.center, outer.center)
        away -= np.round(away)
        if sphere is not outer and np.linalg.norm(away) + sphere.radius <= outer.radius * (1 + 1e-9):
            inside.append((sphere, away))
    for sphere, away in inside:
        held = any(
            np.linalg.norm(away - place) + sphere.radius <= other.radius * (1 + 1e-9)
            for other, place in inside
            if other is not sphere and other.radius > sphere.radius
        )
        found += 0.0 if held else 4 / 3 * np.pi * sphere.radius**3
    return found


def test_spheres_that_fill_a_voxel_leave_no_more_than_it():
    """Quadrature finds a little more of them than there is room; parts of voxels must not add up to more than one."""
    beside = [Sphere((0.8928571428571428, 0.515625, 1.5), 0.49, OTHER)]
    beside += [Sphere((0.7142857142857142, 0.6875, 1.25), 0.044194173824159216, OTHER)]
    beside += [Sphere((0.07142857142857144, 0.75, 0.5), 0.08838834764831843, OTHER)]
    beside += [Sphere((0.9285714285714285, 1.015625, 2.0), 0.216552372064909, OTHER)]
    grid = voxelise(cell(*beside), (7, 16, 1), laminate=True)
    assert_allclose(grid.fractions.sum(), 1.0, rtol=1e-14)  # Rounding.


@pytest.mark.twin
def test_no_write_out_of_bounds(monkeypatch):
    """Room beyond the arrays stays as it was; as plain Python the arrays themselves refuse."""
    kernel, calls = kernels.cut_spheres, []

    def guarded(shape, block, spacing, cuts):
        room = [np.full((len(column) + 9, *column.shape[1:]), -1, column.dtype) for column in cuts]
        found = kernel(shape, block, spacing, Cuts(*(r[: len(c)] for r, c in zip(room, cuts, strict=True))))
        for wide, column in zip(room, cuts, strict=True):
            assert np.all(wide[len(column) :] == -1)
            column[:] = wide[: len(column)]
        calls.append(found)
        return found

    monkeypatch.setattr(kernels, "cut_spheres", guarded)
    for seed in range(40):
        shape, scene = drawn(seed, sides=(1, 2, 3, 5))
        voxelise(scene, shape, laminate=True)
    assert len(calls) >= 40 and max(calls) > 20


@pytest.mark.parametrize(
    ("rule", "said"), [("plain", "miss them or see whole"), ("laminate", "at high contrast"), ("links", "some of them")]
)
def test_inclusions_smaller_than_a_voxel_are_named(rule, said):
    small, large = Sphere((0.3,) * 3, 0.06, OTHER), Sphere((0.7,) * 3, 0.13, OTHER)
    with pytest.warns(
        UserWarning, match=rf"inclusions \[0\] are smaller than a voxel of 0.2 m: rule '{rule}' .*{said}"
    ):
        fft.solve(cell(small, large), voxels=5, rule=rule)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fft.solve(cell(small, large), voxels=9, rule=rule)
