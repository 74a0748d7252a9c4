"""Meshes around cylinders, ellipsoids, boxes, tori and half-spaces: phases, volumes, cells that repeat, narrow gaps."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from solid_shapes import MATRIX, OTHER, TURN
from spared import slow_but

from demheat import Layer, Scene, Sphere
from demheat.scene import Box, Cylinder, Ellipsoid, HalfSpace, Torus
from references.mesh import make
from references.mesh.sizes import wanted_sizes

MIDDLE = (0.5, 0.5, 0.5)
# Through faces, edges and corners of a periodic cell.
AWAY = (0.1, 0.45, 0.93)
SHAPES = {
    "fibre": Cylinder(AWAY, 0.25, (0, 1, 0), OTHER),
    "egg": Ellipsoid(AWAY, (0.46, 0.44, 0.42), OTHER, rotation=TURN),
    "brick": Box(AWAY, (0.5, 0.4, 0.3), OTHER, rotation=TURN),
    "hoop": Torus(AWAY, 0.25, 0.2, (1, 2, 3), OTHER),
    "rod": Cylinder(AWAY, 0.3, (1, 2, 3), OTHER, length=0.6),
}


def cell(*shapes, size=(1.0, 1.0, 1.0), **load):
    return Scene(size, MATRIX, shapes, **(load or {"gradient": (1.0, 0.0, 0.0)}))


@pytest.mark.parametrize("name", slow_but({"brick", "rod"}, SHAPES))
def test_cells_repeat_and_phases_have_their_volumes(name):
    scene = cell(SHAPES[name])
    mesh = make(scene, size=0.25)
    # Second-order elements, a third of a radius long: their middles lie on the surface.
    share = np.bincount(mesh.phase, mesh.volumes)[1]
    assert_allclose(share, SHAPES[name].volume_in((1, 1, 1), periodic=True), rtol=2e-3)
    points = mesh.points[mesh.cells[:, :4]].mean(axis=1)
    assert np.mean(scene.phase_at(points) != mesh.phase) < 0.01
    high, low = mesh.pairs.T
    shift = mesh.points[high] - mesh.points[low]
    assert_allclose(np.sort(np.abs(shift), axis=1), np.tile([0, 0, 1], (len(shift), 1)), atol=1e-12)


def test_half_spaces_end_at_walls():
    mesh = make(cell(HalfSpace((0.5, 0.3, 0.2), (1, 2, 3), OTHER), walls={"x-": 0.0, "x+": 1.0}), size=0.3)
    # x + 2 y + 3 z < 1.7, of which the box cuts off a corner: no edge is bent.
    assert_allclose(np.bincount(mesh.phase, mesh.volumes)[1], (1.7**3 - 0.7**3) / 36, rtol=1e-9)


@pytest.mark.slow
def test_edges_are_short_in_gaps_between_fibres():
    def fibres(gap):
        radius = 0.25 - gap / 4
        return cell(*(Cylinder((x, 0.5, 0.1), radius, (0, 0, 1), OTHER) for x in (0.25, 0.75)), size=(1.0, 1.0, 0.2))

    # Half the root of gap and radius, as between spheres, all along them; to the faces, which count as planes, it is
    # half as wide. Samples are a quarter radius apart.
    for gap in (0.1, 0.01):
        balls = wanted_sizes(fibres(gap), 0.2).balls
        width = math.sqrt(gap / 4 * (0.25 - gap / 4))
        assert 0.499 * width < balls[:, 4].min() < 0.75 * width
    mesh = make(fibres(0.1), size=0.2)
    assert_allclose(np.bincount(mesh.phase, mesh.volumes)[1:], 0.2 * math.pi * 0.225**2, rtol=1e-3)


TOUCHING = {
    "fibres": [Cylinder((x, 0.5, 0.5), 0.25, (0, 0, 1), OTHER) for x in (0.25, 0.75)],
    "a fibre and its image": [Cylinder(MIDDLE, 0.5, (0, 0, 1), OTHER)],
    "a sphere and a fibre": [Cylinder((0.25, 0.5, 0.5), 0.2, (0, 0, 1), OTHER), Sphere((0.65, 0.5, 0.5), 0.2, OTHER)],
    "a layer and a fibre": [Layer(0, 0.7, 0.9, OTHER), Cylinder(MIDDLE, 0.2, (0, 0, 1), OTHER)],
}


@pytest.mark.parametrize("name", TOUCHING)
def test_surfaces_that_touch_are_refused(name, monkeypatch):
    monkeypatch.setattr("references.mesh.cad.call_gmsh", lambda *a, **k: pytest.fail("refused after heavy work"))
    with pytest.raises(NotImplementedError, match="touch"):
        make(cell(*TOUCHING[name]), size=0.2)


def test_a_box_in_a_corner_has_faces_in_walls():
    box = Box((0.2, 0.2, 0.25), (0.4, 0.4, 0.5), OTHER)
    mesh = make(cell(box, walls={"x-": 0.0, "x+": 1.0}), size=0.25)
    assert_allclose(np.bincount(mesh.phase, mesh.volumes)[1], 0.08, rtol=1e-9)
    # Flat faces need one edge along the shortest of them.
    assert_allclose(wanted_sizes(cell(replace(box, center=MIDDLE, sides=(0.1, 0.2, 0.3))), 0.3).balls[:, 4].min(), 0.1)
    flipped = replace(box, rotation=((0, -1, 0), (1, 0, 0), (0, 0, 1)))
    assert flipped.fills_bounds
