"""Unions by every method that takes them: those that are one shape against exact values, necks by all against all.

Overlapping spheres of which one holds the other are a cubic array, endless cylinders on one axis Rayleigh's array of
fibres, boxes that fill the cross-section a laminate. Of two balls that overlap nothing is exact but order: heat through
them is more than through one alone, less than through the ball around both, if they conduct better; and the methods'
own errors.
"""

import pytest
from numpy.testing import assert_allclose, assert_array_equal
from solid_shapes import MATRIX
from spared import slow_but
from test_solids_by_methods import FRACTION, RADIUS, WAYS, rayleigh

from demheat import Material, Scene, Sphere, solve
from demheat.io import scenes
from demheat.scene import Box, Cylinder, Union
from references import exact, fem, fft
from references.voxels.paint import voxelise

MIDDLE = (0.5, 0.5, 0.5)
WALLS = {"walls": {"x-": 0.0, "x+": 1.0}}


def cell(*shapes, depth=1.0, **load):
    return Scene((1.0, 1.0, depth), MATRIX, shapes, **(load or {"gradient": (1.0, 0.0, 0.0)}))


def union(kind, *places, **knobs):
    shapes = [kind(*place, **knobs) for place in places]
    return Union(shapes, shapes[0].material)


# Limits are those of `test_solids_by_methods`, three times what single cylinders err by at these sizes.
@pytest.mark.parametrize("way", WAYS)
def test_a_sphere_in_a_sphere_is_the_outer_one(way):
    run, limit, _ = WAYS[way]
    inside = Material(10.0)
    both = union(Sphere, (MIDDLE, 0.3, inside), ((0.55, 0.5, 0.5), 0.2, inside))
    right = exact.solve(cell(Sphere(MIDDLE, 0.3, inside))).conductivity
    field = run(cell(both))
    assert abs(field.conductivity / right - 1) < limit


@pytest.mark.parametrize("way", WAYS)
def test_fibres_on_one_axis_are_one(way):
    run, limit, depth = WAYS[way]
    inside = Material(0.1)
    both = union(Cylinder, *(((0.5, 0.5, z), RADIUS, (0, 0, 1), inside) for z in (0.1, 0.7)))
    field = run(cell(both, depth=depth))
    assert abs(field.conductivity / rayleigh(FRACTION, 0.1) - 1) < limit
    # Volumes by planes in small cells, and facets.
    assert_allclose(field.fractions[1], FRACTION, rtol=1e-3)


@pytest.mark.parametrize("way", slow_but(WAYS.keys() - {"fem"}, WAYS))
def test_boxes_that_overlap_are_one_slab(way):
    """Faces beyond the walls, exact up to what the solvers leave, across and along."""
    run, _, _ = WAYS[way]
    inside = Material(10.0)
    slab = union(Box, ((0.344, 0.5, 0.5), (0.218, 3.0, 3.0), inside), ((0.554, 0.5, 0.5), (0.222, 3.0, 3.0), inside))
    assert_allclose(run(cell(slab, **WALLS)).conductivity, 1 / (0.43 / 10 + 0.57), rtol=1e-6)
    along = run(cell(slab, walls={"y-": 0.0, "y+": 1.0}))
    assert_allclose(along.conductivity, 10 * 0.43 + 0.57, rtol=1e-6)


def test_no_voxel_is_cut_where_boxes_overlap():
    """By a sixth of a voxel, in the middle of one of its pieces."""
    inside = Material(10.0)
    two = union(Box, ((0.344, 0.5, 0.5), (0.218, 3.0, 3.0), inside), ((0.554, 0.5, 0.5), (0.222, 3.0, 3.0), inside))
    one = Box((0.45, 0.5, 0.5), (0.43, 3.0, 3.0), inside)
    ours, right = (voxelise(cell(each, **WALLS), (16, 8, 8), laminate=True) for each in (two, one))
    assert_array_equal(ours.cut, right.cut)
    assert_allclose(ours.tensor, right.tensor, rtol=1e-9)


@pytest.mark.parametrize("way", ["dem", "fem"])
def test_a_slab_of_two_boxes_resists_on_its_faces_only(way):
    inside = Material(10.0)
    shapes = [Box((x, 0.5, 0.5), (0.23, 3.0, 3.0), inside) for x in (0.35, 0.55)]
    scene = cell(Union(shapes, inside, resistance=0.1), **WALLS)
    assert_allclose(1 / WAYS[way][0](scene).conductivity, 0.43 / 10 + 0.57 + 2 * 0.1, rtol=1e-6)


def neck(contrast):
    inside = Material(contrast)
    return union(Sphere, *(((x, 0.5, 0.5), 0.25, inside) for x in (0.35, 0.65)))


def eighth(contrast):
    """An eighth of a cell with such a neck in its middle, which has that of the cell: planes of symmetry are walls."""
    inside = Material(contrast)
    both = union(Sphere, *(((x, 0.0, 0.0), 0.25, inside) for x in (-0.15, 0.15)))
    return Scene((0.5, 0.5, 0.5), MATRIX, [both], walls={"x-": 0.0, "x+": 1.0})


NECKS = {
    "dem": lambda scene: solve(scene, particles=1000),
    "fft": lambda scene: fft.solve(scene, voxels=12, rule="laminate", threads=1),
    "fem": lambda scene: fem.solve(scene, size=0.12),
}


def test_necks_lie_between_and_methods_agree(contrast=10.0):
    inside = Material(contrast)
    found = {way: run(eighth(contrast)) for way, run in NECKS.items()}
    # In a whole cell, half as fine.
    found["cell"] = NECKS["fft"](cell(neck(contrast)))
    less, more = (exact.solve(cell(Sphere(MIDDLE, r, inside))).conductivity for r in (0.25, 0.4))
    for way, field in found.items():
        assert min(less, more) < field.conductivity < max(less, more), way
        for other in found.values():
            assert max(field.error.lower, other.error.lower) < min(field.error.upper, other.error.upper), way


def test_meshes_know_one_piece():
    pieces = union(Sphere, *(((x, 0.5, 0.5), 0.1, Material(2.0)) for x in (0.3, 0.7)))
    with pytest.raises(NotImplementedError, match="is 2 pieces: meshes know one"):
        fem.solve(cell(pieces), size=0.3)


def test_files_hold_them(tmp_path):
    inside, path = Material(3.0), tmp_path / "scene.toml"
    shapes = [
        Sphere(MIDDLE, 0.2, inside),
        Box((0.6, 0.5, 0.5), (0.3, 0.2, 0.1), inside, rotation=(0.1, 0.2, 0.3)),
        Cylinder(MIDDLE, 0.1, (0, 1, 2), inside, length=0.5),
    ]
    scene = cell(Union(shapes, inside, resistance=0.1), Sphere((0.1, 0.1, 0.1), 0.05, inside))
    scenes.write(scene, path)
    assert repr(scenes.read(path)) == repr(scene)
    path.write_text(
        """size = [1, 1, 1]
matrix = {conductivity = 1}
gradient = [1, 0, 0]
[[inclusions]]
shape = "union"
material = {conductivity = 3}
[[inclusions.shapes]]
shape = "sphere"
center_mm = [500, 500, 500]
radius_mm = 200
[[inclusions.shapes]]
shape = "box"
center = [0.7, 0.5, 0.5]
sides = [0.3, 0.2, 0.1]
"""
    )
    (read,) = scenes.read(path).inclusions
    assert read == Union([Sphere(MIDDLE, 0.2, inside), Box((0.7, 0.5, 0.5), (0.3, 0.2, 0.1), inside)], inside)
    text = path.read_text()
    for old, new, words in (
        ("= 200", "= -200", r"10: inclusions\[0\].shapes\[0\].radius_mm = -200"),
        ('"box"', '"layer"', r"12: inclusions\[0\].shapes\[1\].shape = 'layer': must be one of 'sphere', 'cylinder'"),
        ("radius_mm", 'material = "x"\nradius_mm', r"10: inclusions\[0\].shapes\[0\].material: no such key here"),
        (text[text.rindex("[[") :], "", r"7: inclusions\[0\].shapes = .*two or more"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(ValueError, match=words) as refused:
            scenes.read(path)
        assert "\n" not in str(refused.value)
