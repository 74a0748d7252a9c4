"""Only here: resistances of surfaces left out between two phases, or mirrored where surfaces are unlike."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Box, Layer, Material, Scene, Sphere, recommend
from demheat.scene.negligible import negligible
from demheat.scene.resistances import between, joined, on_facets
from demheat.scene.symmetry import alike_axes, mirrors, reduced

GOOD = Material(30.0)


def cell(*inclusions, gradient=(1.0, 0.0, 0.0)):
    return Scene((1.0, 1.0, 1.0), Material(2.0), inclusions, gradient=gradient)


def box(*inclusions):
    return Scene((1.0, 1.0, 1.0), Material(2.0), inclusions, walls={"x-": 0.0, "x+": 1.0})


def ball(x, y, z, resistance=0.0, radius=0.1):
    return Sphere((x, y, z), radius, GOOD, resistance=resistance)


def layer(start, stop, resistance=0.0, material=GOOD):
    return Layer(0, start, stop, material, resistance=resistance)


def test_it_is_a_keyword_and_part_of_the_shape():
    with pytest.raises(TypeError):
        Sphere((0.5, 0.5, 0.5), 0.1, GOOD, 1e-3)
    shape = ball(0.9, 0.5, 0.2, resistance=1)
    assert shape.resistance == 1.0 and isinstance(shape.resistance, float)
    assert shape != ball(0.9, 0.5, 0.2) and ball(0.9, 0.5, 0.2).resistance == 0.0
    assert {each.resistance for each in shape.images((1.0, 1.0, 1.0), periodic=True)} == {1.0}
    assert shape.turned((1, 2, 0)).resistance == layer(0.2, 0.4, 1.0).turned((1, 2, 0)).resistance == 1.0
    assert_array_equal(cell(shape, layer(0.2, 0.4)).resistances, [0.0, 1.0, 0.0])


def test_heat_meets_all_surfaces_between_two_phases():
    # Phase 1 holds 2, which holds 3; 4 lies beside them.
    nest = [
        Sphere((0.3, 0.5, 0.5), radius, GOOD, resistance=r) for radius, r in ((0.2, 1.0), (0.15, 20.0), (0.1, 300.0))
    ]
    scene = cell(*nest, ball(0.8, 0.5, 0.5, 4000.0))
    met = between(scene)
    here = np.array([0, 0, 1, 0, 3, 3, 4, 2])
    there = np.array([0, 1, 2, 3, 1, 4, 0, 2])
    assert_array_equal(met(here, there), [0, 1, 20, 321, 320, 4321, 4000, 0])
    assert_array_equal(met(there, here), met(here, there))
    assert_array_equal(joined(scene), [0, 1, 2, 3, 4])
    assert_array_equal(joined(cell(nest[0], replace(nest[1], resistance=0.0), nest[2])), [0, 1, 1, 3])
    assert between(cell(ball(0.5, 0.5, 0.5))) is None


def test_a_facet_that_leans_is_as_much_surface_as_it_covers():
    # Phase 1 holds 2; facets on a face of the box, beyond one of the cell, of which two lean by 60 degrees.
    block = Box((0.9, 0.5, 0.5), (0.4, 0.4, 0.4), GOOD, resistance=3.0)
    met = on_facets(cell(block, ball(0.9, 0.5, 0.5, 50.0)))
    lean = np.array([[1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0], [-0.5, 0.0, np.sqrt(0.75)]])
    outside, points = np.zeros(3, int), np.array([[0.1, 0.5, 0.5], [1.1, 0.5, 0.5], [0.1, 0.45, 0.5]])
    assert_allclose(met(outside, outside + 1, points, lean), [3.0, 6.0, 6.0], rtol=1e-12)  # rounding
    assert_allclose(met(outside + 1, outside, points, -lean), [3.0, 6.0, 6.0], rtol=1e-12)
    # Of two surfaces between two phases each counts by its own normal; facets of spheres have no steps.
    assert_allclose(met(outside, outside + 2, points, lean), [53.0, 56.0, 56.0], rtol=1e-12)
    assert_array_equal(met(outside + 1, outside + 2, points, lean), [50.0] * 3)
    upright = met(outside, outside + 1, points, np.tile([0.0, 1.0, 0.0], (3, 1)))
    assert np.all(upright > 1e8) and np.all(np.isfinite(upright))
    assert on_facets(cell(ball(0.5, 0.5, 0.5))) is None


def test_on_spheres_and_layers_facets_are_all_surface():
    scene = cell(ball(0.3, 0.5, 0.5, 2.0), layer(0.6, 0.9, 0.5))
    here, there, points = np.array([0, 2, 1]), np.array([1, 0, 2]), np.full((3, 3), 0.4)
    found = on_facets(scene)(here, there, points, np.eye(3))
    assert_array_equal(found, between(scene)(here, there))


def test_what_does_not_say_that_it_can_refuses_it():
    scene = cell(ball(0.3, 0.5, 0.5), ball(0.7, 0.5, 0.5, 1e-8))
    what = r"^Scene.inclusions\[1\].resistance = 1e-08 m2 K/W, where only perfect interfaces, 0, are known"
    with pytest.raises(NotImplementedError, match=what + ": it knows better$"):
        scene.require("it knows better")
    with pytest.raises(NotImplementedError, match=what + "$"):
        scene.require(steady=True)
    scene.require("it can", takes=("resistance",))
    cell(ball(0.3, 0.5, 0.5)).require("nothing resists")


def test_unlike_surfaces_are_no_mirror_images_and_no_axes_alike():
    one, other = (0.25, 0.5, 0.5), (0.75, 0.5, 0.5)
    same = box(ball(*one, 1e-3), ball(*other, 1e-3))
    assert mirrors(same) == (0.5, 0.5, 0.5)
    assert mirrors(box(ball(*one, 1e-3), ball(*other))) == (None, 0.5, 0.5)
    corners = [ball(0.5, 0.25, 0.5, 1e-3), ball(0.5, 0.75, 0.5, 1e-3)]
    assert alike_axes(cell(ball(*one, 1e-3), ball(*other, 1e-3), *corners))[:2] == (0, 0)
    plain = [replace(each, resistance=2e-3) for each in corners]
    assert alike_axes(cell(ball(*one, 1e-3), ball(*other, 1e-3), *plain))[:2] == (0, 1)
    part = reduced(same)
    assert part.factors == (2, 2, 2) and {each.resistance for each in part.scene.inclusions} == {1e-3}


def test_no_cut_where_layers_that_resist_meet():
    """A wall there would not resist: the mirror plane lies on an interface of twice the resistance."""
    meet, gap = [layer(0.3, 0.5, 1e-3), layer(0.5, 0.7, 1e-3)], [layer(0.2, 0.4, 1e-3), layer(0.6, 0.8, 1e-3)]
    assert reduced(box(*meet)).factors == (1, 2, 2)
    assert reduced(box(*gap)).factors == (2, 2, 2)
    assert reduced(box(*(replace(each, resistance=0.0) for each in meet))).factors == (2, 2, 2)
    # Planes of the cell: in the middle, and half a period on, where layers meet over its face.
    assert reduced(cell(*meet)).factors == (1, 1, 1)
    assert reduced(cell(layer(0.0, 0.1, 1e-3), layer(0.9, 1.0, 1e-3))).factors == (1, 1, 1)
    assert reduced(cell(*gap)).factors == (2, 2, 2)


def test_spheres_that_resist_are_not_negligible():
    scene = cell(ball(0.3, 0.5, 0.5, radius=0.01), ball(0.7, 0.5, 0.5, 1e-3, radius=0.01))
    assert negligible(scene, 1e-3).inclusions == (0,)


def test_laws_of_error_are_asked_of_films():
    """Methods with elements offer themselves by laws for perfect interfaces; what knows the films comes first."""
    crowd = [ball(0.3, 0.5, 0.5, 1e-3), ball(0.72, 0.45, 0.4, 2e-3)]
    found = {way.method: way for way in recommend(cell(*crowd)).ways}
    for method in ("fem", "fft", "dem"):
        assert not found[method].refused and found[method].cpu_s > found["multipole"].cpu_s
    assert recommend(cell(*crowd)).method == "multipole"
    assert recommend(cell(layer(0.2, 0.4, 1e-3))).method == "exact"
