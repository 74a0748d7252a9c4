"""Only here: a shape that nobody knows and that somebody takes for a sphere, or refuses with more than a line."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Box, Layer, Material, Scene, Sphere, referee, solve
from demheat.io import scenes
from demheat.scene.inputs import vector
from demheat.scene.shapes import Shape
from demheat.scene.shapes.periodic import nearest
from demheat.scene.symmetry import alike_axes, mirrors, reduced
from demheat.scene.volumes import fractions
from references import exact, fem, fft, multipole
from references.voxels.paint import voxelise

MATRIX, OTHER = Material(1.0, 1.0, 1.0), Material(5.0, 1.0, 1.0)


@dataclass(frozen=True)
class Brick(Shape):
    """A box with its sides along the axes."""

    center: tuple[float, float, float]
    sides: tuple[float, float, float]
    material: Material

    fills_bounds = True

    def __post_init__(self):
        for name in ("center", "sides"):
            object.__setattr__(self, name, vector(f"Brick.{name}", getattr(self, name)))

    def distance(self, points, *, period=None):
        beyond = np.abs(nearest(points - self.center, period)) - np.array(self.sides) / 2
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)

    def normal(self, points, *, period=None):
        offsets = nearest(points - self.center, period)
        beyond = np.abs(offsets) - np.array(self.sides) / 2
        out = np.maximum(beyond, 0.0)
        out[np.arange(len(out)), beyond.argmax(axis=1)] += np.all(beyond <= 0, axis=1)
        return np.copysign(out, offsets) / np.linalg.norm(out, axis=1, keepdims=True)

    def bounds(self):
        center, half = np.array(self.center), np.array(self.sides) / 2
        return center - half, center + half

    @property
    def volume(self):
        return float(np.prod(self.sides))

    def turned(self, order):
        return replace(self, **{n: tuple(getattr(self, n)[a] for a in order) for n in ("center", "sides")})


def cell(*inclusions, size=(1.0, 1.0, 1.0), **load):
    return Scene(size, MATRIX, inclusions, **(load or {"gradient": (0.0, 1.0, 0.0)}))


WALLS = {"walls": {"y-": 0.0, "y+": 1.0}}
CENTRED = Brick((0.5, 0.5, 0.5), (0.5, 0.375, 0.75), OTHER)
# Through two faces of a periodic cell.
CROSSING = replace(CENTRED, center=(0.0, 0.5, 0.9375))
# Across the whole cell: a layer.
ACROSS = Brick((0.5, 0.5, 0.5), (1.0, 0.25, 1.0), OTHER)


def test_its_symmetry_is_not_known():
    for scene in (cell(CENTRED), cell(CENTRED, **WALLS)):
        assert mirrors(scene) == (None, None, None) and alike_axes(scene) == (0, 1, 2)
        assert reduced(scene).scene is scene


def test_its_phases():
    inner = Brick((0.0, 0.5, 0.9375), (0.25, 0.25, 0.25), MATRIX)
    scene = cell(CROSSING, inner)
    points = np.random.default_rng(0).random((20_000, 3))
    away = np.abs((points - CROSSING.center + 0.5) % 1.0 - 0.5)
    wanted = sum(np.all(away <= half, axis=1).astype(int) for half in (np.array(CROSSING.sides) / 2, 0.125))
    assert_array_equal(scene.phase_at(points), wanted)
    assert set(wanted) == {0, 1, 2}
    assert_array_equal(scene.phase_at(points + [1.0, -2.0, 3.0]), wanted)
    assert_array_equal(scene.parents(), [0, 0, 1])
    assert_allclose(fractions(scene)[1:], [CENTRED.volume - 1 / 64, 1 / 64], rtol=1e-14)
    assert len(scene.images()) == 4 + 4


@pytest.mark.parametrize("scene", [cell(CENTRED), cell(CROSSING), cell(CENTRED, **WALLS)])
def test_its_voxels(scene):
    grid = voxelise(scene, (16, 16, 16), laminate=False)
    # Sides are whole voxels, and no centre of a voxel lies on a face.
    assert grid.fractions[1] == CENTRED.volume
    # Where they are not, voxels at its faces are told by their centres.
    shape = (15, 17, 19)
    grid = voxelise(scene, shape, laminate=False)
    middles = (np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), -1) + 0.5) / shape
    assert_array_equal(grid.phase.ravel(), scene.phase_at(middles))


@pytest.mark.parametrize("rule", ["plain", "laminate", "links"])
def test_its_cut_voxels_and_links_are_those_of_a_box(rule):
    brick = replace(CENTRED, sides=(0.51, 0.37, 0.71))
    scenes = cell(brick), cell(Box(brick.center, brick.sides, OTHER))
    ours, box = (fft.solve(each, voxels=16, rule=rule, threads=1).conductivity for each in scenes)
    assert_allclose(ours, box, rtol=1e-9)


def test_its_facets_are_found_by_its_distance_alone():
    """Points spread evenly over its edges, where a box has squares on each face that end before them: rougher."""
    scenes = cell(CENTRED), cell(Box(CENTRED.center, CENTRED.sides, OTHER))
    ours, box = (solve(each, particles=2000) for each in scenes)
    # Found: 0.6 %, and 0.2 % of the volume.
    assert_allclose(ours.conductivity, box.conductivity, rtol=0.01)
    assert_allclose(ours.fractions[1], CENTRED.volume, rtol=0.01)


def test_a_brick_across_the_cell_is_a_layer_to_every_method_that_takes_it():
    layer = Layer(1, 0.375, 0.625, OTHER)
    for load in ({}, WALLS):
        bricks, layers = cell(ACROSS, **load), cell(layer, **load)
        right = exact.solve(layers).conductivity
        plain = (fft.solve(each, voxels=16, rule="plain", threads=1).conductivity for each in (bricks, layers))
        assert_allclose(*plain, rtol=1e-9)
        # Facets of a few hundred particles are as rough as the layer is thick: this law alone costs some per cent.
        dem = {"particles": 2000, "conforming": False, "seed": 0}
        assert_allclose(solve(bricks, **dem).conductivity, solve(layers, **dem).conductivity, rtol=1e-12)
        assert abs(solve(bricks, **dem).conductivity / right - 1) < 0.1


def test_the_dem_between_walls_balances_heat_around_it():
    field = solve(cell(CENTRED, **WALLS), particles=2000, conforming=False)
    assert abs(referee.heat_balance(field)) < 1e-7  # the solver's tolerance is 1e-8 of what flows in the bulk
    # Centres in or out of a brick of some 280 particles.
    assert_allclose(field.fractions[1], CENTRED.volume, atol=0.02)
    along, across = (field.fractions @ [1, 5], 1 / (field.fractions @ [1, 0.2]))
    assert across < field.conductivity < along


def test_elements_are_cut_along_its_surface():
    """Edges are cut off, by at most a triangle of half a cube's side: a mesh of corners that nobody told it of."""
    brick = replace(CENTRED, center=(0.47, 0.52, 0.5))
    ours, box = (fem.solve(cell(each), size=0.06) for each in (brick, Box(brick.center, brick.sides, OTHER)))
    cut = 4 * sum(brick.sides) * (1 / 12) ** 2 / 8
    assert 0 < brick.volume - ours.fractions[1] < cut
    # What is cut off conducts no better than as layers along the load.
    assert 0 < box.conductivity - ours.conductivity < cut * (OTHER.conductivity - 1)


REFUSALS = {
    "bricks": (
        lambda scene: next(
            fem.evolve(replace(scene, gradient=None, initial=0.0), [1.0], elements="hexahedra"),
        ),
        r"Scene.inclusions\[0\]: hexahedra follow boxes of layers only",
    ),
    "multipoles": (multipole.solve, r"a brick, Scene.inclusions\[1\]: multipole knows disjoint spheres"),
    "closed forms": (exact.solve, "no closed form"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_what_does_not_know_it_refuses_it_in_one_line(name, monkeypatch):
    for heavy in ("demheat.packing.relax.relax", "references.mesh.cad.session"):
        monkeypatch.setattr(heavy, lambda *a, **k: pytest.fail("refused after heavy work"))
    ask, words = REFUSALS[name]
    scene = cell(Sphere((0.5, 0.1, 0.5), 0.05, OTHER), replace(CENTRED, center=(0.5, 0.6, 0.5)))
    with pytest.raises(NotImplementedError, match=words) as refused:
        ask(scene)
    assert "\n" not in str(refused.value)


def test_no_file_holds_it(tmp_path):
    with pytest.raises(ValueError, match=r"Scene.inclusions\[0\] = Brick.*: must be one of sphere, layer,.* in a file"):
        scenes.write(cell(CENTRED), tmp_path / "scene.toml")


@pytest.mark.parametrize(
    ("inclusions", "words"),
    [
        ([CENTRED, replace(CENTRED, center=(0.6, 0.5, 0.5))], "overlap partially"),
        ([CENTRED, replace(CENTRED, sides=(0.6, 0.5, 0.8))], "hidden"),
        ([Sphere((0.5, 0.5, 0.5), 0.3, OTHER), CENTRED], "overlap partially"),
        ([Sphere((0.5, 0.5, 0.5), 0.1, OTHER), CENTRED], "hidden"),
        ([Layer(0, 0.3, 0.6, OTHER), CENTRED], "overlap partially"),
        ([replace(CENTRED, sides=(0.5, 1.1, 0.5))], "brick of diameter 1.1 is larger than the box; must be <= 1.0"),
    ],
)
def test_where_it_may_not_lie(inclusions, words):
    with pytest.raises(ValueError, match=words):
        cell(*inclusions)


@pytest.mark.parametrize(
    "inclusions",
    [
        # Touching bricks, and one in each other, to rounding.
        [Brick((0.2, 0.5, 0.5), (0.2, 0.2, 0.2), OTHER), Brick((0.4, 0.5, 0.5), (0.2, 0.2, 0.2), OTHER)],
        [CENTRED, replace(CENTRED, sides=(0.5, 0.3, 0.2))],
        # A ball at a face, at an edge, at a corner, and inside.
        [CENTRED, Sphere((0.5, 0.1, 0.5), 0.2125, OTHER)],
        [Sphere((0.85, 0.8875, 0.5), 0.2236, OTHER), CENTRED],
        [CENTRED, Sphere((0.5, 0.5, 0.5), 0.1875, OTHER)],
        # In a ball, its corners on it, and off the middle; in a layer; beside one.
        [Sphere((0.5, 0.5, 0.5), 0.5, OTHER), Brick((0.5, 0.5, 0.5), (0.6, 0.48, 0.64), OTHER)],
        [Sphere((0.5, 0.5, 0.5), 0.5, OTHER), Brick((0.5, 0.5, 0.7), (0.6, 0.48, 0.2), OTHER)],
        [Layer(0, 0.25, 0.75, OTHER), CENTRED],
        [Layer(0, 0.75, 0.9, OTHER), CENTRED],
        [Layer(0, 0.25, 0.75, OTHER), CROSSING],
    ],
)
def test_where_it_may_lie(inclusions):
    assert len(cell(*inclusions).inclusions) == 2
