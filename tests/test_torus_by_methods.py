"""Only here: a ring that one method takes for another body than the others do, or in whose hole nothing may lie."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from solid_shapes import MATRIX, RING

from demheat import Cylinder, Material, Scene, Sphere, Torus, solve
from demheat.io import scenes
from demheat.scene.shapes.level_set import ASIDE
from references import fem, fft

MIDDLE = (0.5, 0.5, 0.5)


def ring(contrast, center=MIDDLE, axis=(0, 0, 1), **knobs):
    return Torus(center, 0.28, 0.12, axis, Material(contrast), **knobs)


def cell(*shapes, **load):
    return Scene((1.0, 1.0, 1.0), MATRIX, shapes, **(load or {"gradient": (1.0, 0.0, 0.0)}))


def eighth(contrast, axis, **knobs):
    """An eighth of such a cell, which has the conductivity of the cell: planes of symmetry are walls."""
    return Scene((0.5, 0.5, 0.5), MATRIX, [ring(contrast, (0, 0, 0), axis, **knobs)], walls={"x-": 0.0, "x+": 1.0})


WAYS = {
    "dem": lambda scene: solve(scene, particles=1000),
    "laminate": lambda scene: fft.solve(scene, voxels=16, rule="laminate", threads=1),
    "links": lambda scene: fft.solve(scene, voxels=16, rule="links", threads=1),
    "plain": lambda scene: fft.solve(scene, voxels=16, rule="plain", threads=1),
    "fem": lambda scene: fem.solve(scene, size=0.12),
}


@pytest.mark.parametrize(
    ("contrast", "axis"), [(10.0, (0, 0, 1)), pytest.param(0.1, (1, 0, 0), marks=pytest.mark.slow)]
)
def test_methods_agree_within_their_intervals(contrast, axis):
    found = {way: run(eighth(contrast, axis)) for way, run in WAYS.items()}
    for way, field in found.items():
        for other in found.values():
            assert max(field.error.lower, other.error.lower) < min(field.error.upper, other.error.upper), way
    # Means over the phases, across them and along; what is asserted above says something only of narrow intervals.
    share = ring(contrast).volume
    assert 1 / (1 + share * (1 / contrast - 1)) < found["fem"].conductivity < 1 + share * (contrast - 1)
    assert found["fem"].error.upper - found["fem"].error.lower < 0.01


def test_turned_and_through_faces_of_a_cell_it_is_the_same():
    """Where in a cell it lies changes how it is cut, not what it conducts; a tenth of the interval is rounding."""
    one = [fft.solve(cell(ring(10.0, axis=(1, 2, 3))), voxels=24, rule="laminate", threads=1)]
    one += [fft.solve(cell(ring(10.0, (0.1, 0.45, 0.93), (1, 2, 3))), voxels=24, rule="laminate", threads=1)]
    one += [solve(cell(ring(10.0, (0.1, 0.45, 0.93), (1, 2, 3))), particles=2000)]
    for field in one:
        assert_allclose(field.fractions[1], ring(1.0).volume, rtol=1e-3)  # of facets 4e-5 was found
        assert one[0].error.lower < field.conductivity < one[0].error.upper


def test_its_surface_may_resist():
    """A third of what the ring adds to the matrix is lost at a coat, and the two methods that know one agree."""
    dem, fem_ = (WAYS[way](eighth(10.0, (0, 0, 1), resistance=0.05)) for way in ("dem", "fem"))
    assert max(dem.error.lower, fem_.error.lower) < min(dem.error.upper, fem_.error.upper)
    # Elements of both sizes, .12 and .06, gave 1.2229, without a coat 1.3237.
    assert_allclose([dem.conductivity, fem_.conductivity], 1.2229, rtol=2e-3)


def test_it_is_the_level_set_of_its_function():
    points = np.random.default_rng(0).random((4000, 3))
    torus = replace(ring(5.0), material=RING.material)
    assert_array_equal(torus.contains(points), RING.contains(points))
    # Feet may be that far aside of the nearest points; Newton's steps end nearer to the surface than 1e-9.
    assert_allclose(torus.distance(points), RING.distance(points), rtol=ASIDE**2, atol=1e-9)


def test_spheres_lie_in_its_hole_and_in_its_tube():
    hole, bead = Sphere(MIDDLE, 0.16, MATRIX), Sphere((0.78, 0.5, 0.5), 0.12, MATRIX)
    assert cell(ring(5.0), hole, bead).parents().tolist() == [0, 0, 0, 1]
    for wrong in (replace(hole, radius=0.1601), replace(bead, radius=0.1201), replace(bead, center=(0.7, 0.5, 0.5))):
        with pytest.raises(ValueError, match="overlap partially"):
            cell(ring(5.0), wrong)
    # All corners around it lie in the tube, and its middle in the hole.
    with pytest.raises(ValueError, match="overlap partially"):
        cell(ring(5.0), Cylinder(MIDDLE, 0.02, (1, 0, 0), MATRIX, length=0.56))


def test_a_box_in_its_hole_is_outside():
    walls = {"walls": {"x-": 0.0, "x+": 1.0}}
    with pytest.raises(ValueError, match="lies outside the box"):
        cell(Torus(MIDDLE, 2.0, 1.0, (0, 0, 1), MATRIX), **walls)
    # A wall cuts its tube beside the circle.
    for cut in (ring(5.0, (0.5, 0.5, -0.1)), ring(5.0, (0.5, 0.5, -0.25), (1, 0, 1)), ring(5.0, (0.5, 0.5, 0.5))):
        point = cell(cut, **walls).inclusions[0].point_in((1, 1, 1), periodic=False)
        assert cut.contains(point[None])[0] and np.all((point >= 0) & (point <= 1))
    away = ring(5.0, (0.9, 0.1, 0.0))
    assert away.contains(away.point_in((1, 1, 1), periodic=True)[None], period=np.ones(3))[0]


def test_files_hold_it(tmp_path):
    scene, path = cell(ring(5.0, axis=(1, 2, 3), resistance=0.1)), tmp_path / "scene.toml"
    scenes.write(scene, path)
    assert repr(scenes.read(path)) == repr(scene)
    text = path.read_text()
    path.write_text(text.replace("tube = 0.12", "tube_mm = 120"))
    assert scenes.read(path) == scene
    path.write_text(text.replace("tube = 0.12", 'tube = "30 cm"'))
    with pytest.raises(ValueError, match=r"scene.toml:\d+: inclusions\[0\].tube = '30 cm': must be > 0 m and less"):
        scenes.read(path)


def test_what_resists_is_as_wide_as_its_surface():
    """By the area of their facets with its steps all were too high from 8000 particles on, and hardly came nearer."""
    # Finite elements .02 long: 1.0468927 to 1.0469101.
    known = 1.0469014
    own = Torus(MIDDLE, 0.28, 0.11, (0, 1, 0), Material(40.0), resistance=0.05)
    few, many = (solve(cell(own, gradient=(0.0, 1.0, 0.0)), particles=n) for n in (4000, 16000))
    assert many.error.lower < known < many.error.upper
    # The square of the size: 4^(2/3) = 2.5; with steps .9, and with the first power 1.6.
    assert 2.0 < (known - few.conductivity) / (known - many.conductivity) < 3.0
