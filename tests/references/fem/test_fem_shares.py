"""Rows of all ranks are those of the whole mesh, whatever their number."""

import numpy as np
import pytest
from ranks import on_ranks
from scipy.sparse import diags, vstack

from demheat import Material, Scene, Sphere, gallery
from references.fem.elements import assemble
from references.fem.shares import assembled, shares_of, unknown_rows
from references.fem.system import given_part
from references.mesh import make, twins

CELL = Scene((1.0, 1.3, 0.9), Material(1.0), [Sphere((0.5, 0.6, 0.4), 0.3, Material(7.0))], gradient=(1.0, 0.5, 0.0))


@pytest.mark.parametrize(("scene", "size", "order"), [(CELL, 0.7, 2), (gallery.sphere_in_cube(5.0), 0.04, 1)])
def test_rows_of_all_ranks_are_those_of_the_whole(scene, size, order):
    mesh = make(scene, size=size, order=order)
    dof, given = twins(len(mesh.points), mesh.pairs), given_part(scene, mesh, np.ones(len(mesh.cells), dtype=bool))
    unit = scene.conductivities.max()
    whole, load = assemble(mesh, scene.conductivities[mesh.phase] / unit, dof, given.lift)

    def work(comm):
        share = shares_of(mesh, given.shares > 0, comm)
        matrix, own = assembled(scene, mesh, share, given.lift, unit)
        return share, matrix, own, *unknown_rows(matrix, share)

    found = on_ranks(3, work)
    rows = np.concatenate([share.own for share, *_ in found])
    np.testing.assert_array_equal(np.sort(rows), np.unique(dof))
    # Sums of some ten elements in another order.
    near = {"rtol": 0, "atol": 1e-13 * abs(whole).max()}
    np.testing.assert_allclose(vstack([matrix for _, matrix, *_ in found]).toarray(), whole[rows].toarray(), **near)
    most = np.abs(load).max()
    np.testing.assert_allclose(np.concatenate([own for _, _, own, *_ in found]), load[rows], rtol=0, atol=1e-13 * most)
    free = rows[found[0][0].numbers[rows] >= 0]
    assert len(free) == len(rows) - (1 if scene.periodic else np.count_nonzero(given.shares))
    scale = diags(1.0 / np.sqrt(whole.diagonal()[free]))
    scaled = (scale @ whole[free][:, free] @ scale).toarray()
    np.testing.assert_allclose(vstack([part for *_, part, _ in found]).toarray(), scaled, rtol=0, atol=1e-13)


def test_more_ranks_than_nodes_are_refused():
    mesh = make(CELL, size=0.9, order=1)

    def work(comm):
        with pytest.raises(ValueError, match=rf"ranks = {comm.size}: the mesh has 2 nodes"):
            shares_of(mesh._replace(points=mesh.points[:2], pairs=mesh.pairs[:0]), np.zeros(2, dtype=bool), comm)

    on_ranks(3, work)
