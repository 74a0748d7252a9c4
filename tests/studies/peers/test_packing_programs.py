"""Voro++ and spheropack, where they are; facets of given cells anywhere."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import gallery
from demheat.packing import make_packing
from studies.peers import given
from studies.peers.programs import multivoro, spheropack


def test_facets_of_two_cells():
    """A box of 2 x 1 x 1 cut across x: a facet of 1 m2 a metre from each, and the walls."""
    packing = make_packing([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]], [0.5, 0.5], (2.0, 1.0, 1.0), False, {})
    point = np.array([[x, y, z] for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    ring = np.array([0, 1, 3, 2])
    owner, neighbour, corner = [], [], []
    for cell in (0, 1):
        low, high = 4 * cell, 4 * cell + 4
        # The faces across x, towards the other or a wall; then those across y and z.
        owner += [cell] * 6
        neighbour += [-1 if cell == 0 else 0, 1 if cell == 0 else -2, -3, -4, -5, -6]
        corner += [low + ring, high + ring]
        corner += [[low, low + 1, high + 1, high], [low + 2, low + 3, high + 3, high + 2]]
        corner += [[low, low + 2, high + 2, high], [low + 1, low + 3, high + 3, high + 1]]
    raw = {"owner": np.array(owner), "neighbour": np.array(neighbour), "length": np.full(12, 4)}
    facets = multivoro.facets_of(packing, raw | {"corner": np.concatenate(corner), "point": point})
    assert_allclose(facets.area, 1.0), assert_allclose(facets.distance, 0.5)
    assert_allclose(facets.volumes, 1.0), assert_allclose(facets.wall_distance, 0.5)
    assert sorted(facets.wall_side) == [0, 1, 2, 2, 3, 3, 4, 4, 5, 5] and facets.indices.tolist() == [1, 0]
    with pytest.raises(RuntimeError, match="one of its two cells"):
        one = neighbour.index(0)
        lost = {name: np.delete(raw[name], one) for name in raw}
        kept = np.concatenate([c for i, c in enumerate(corner) if i != one])
        multivoro.facets_of(packing, lost | {"corner": kept, "point": point})


@pytest.mark.skipif(multivoro.missing() is not None, reason=str(multivoro.missing()))
def test_cells_by_voro():
    from demheat.packing.cache import relaxed

    packing = relaxed(300, size=(1.0, 1.0, 1.0), periodic=False)
    facets, cost = multivoro.cells(packing)
    ours, _ = multivoro._ours(packing)
    # Rounding of vertices, 1e-16 of the box, against facets of some hundredths of it.
    assert multivoro._apart(facets, ours) < 1e-12 and cost["cpu_s"] > 0
    assert_allclose(facets.volumes, ours.volumes, rtol=1e-11)


@pytest.mark.skipif(multivoro.missing() is not None, reason=str(multivoro.missing()))
def test_a_body_by_cells_of_voro():
    found = multivoro.solve(given.scene("layers off the grid"), particles=300)
    assert_allclose(found.conductivity, given.known("layers off the grid"), rtol=1e-9)


@pytest.mark.skipif(spheropack.missing() is not None, reason=str(spheropack.missing()))
def test_a_body_by_spheropack():
    scene = given.scene("layers off the grid")
    found = spheropack.solve(scene, particles=300, conforming=True, density=0.5)
    # Twins on the interface: exact whatever the packing.
    assert_allclose(found.conductivity, given.known("layers off the grid"), rtol=1e-9)
    assert "target at 0.5000" in found.note


def test_periodic_cells_are_refused():
    cell = gallery.slab(size=(1.0, 1.0, 1.0), periodic=True)
    for solve in (multivoro.solve, lambda scene, **k: spheropack.solve(scene, conforming=True, **k)):
        with pytest.raises(NotImplementedError, match="boxes between walls"):
            solve(cell, particles=100)
