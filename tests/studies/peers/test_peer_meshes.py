"""Files of the mesh that finite elements of others are given."""

import numpy as np
import pytest

from references import fem
from references.mesh import EDGE_COLUMN
from references.mesh.cells import volumes_of
from studies.peers import given, meshes

SIZE = 0.2


@pytest.fixture(params=[1, 2])
def mesh(request):
    return meshes.conforming(given.scene("sphere 10"), size=SIZE, order=request.param)


def test_it_is_the_mesh_of_our_elements(mesh):
    order = 1 if mesh.cells.shape[1] == 4 else 2
    ours = fem.solve(given.scene("sphere 10"), size=SIZE, order=order, curved=False)
    assert (len(mesh.points), len(mesh.cells)) == (ours.stats["nodes"], ours.stats["elements"])
    assert meshes.unknowns(mesh) == ours.stats["unknowns"]
    assert not mesh.curved.any()


def test_msh(mesh, tmp_path):
    meshio = pytest.importorskip("meshio")
    meshes.write_msh(tmp_path / "body.msh", mesh)
    back = meshio.read(tmp_path / "body.msh")
    kinds = {4: ("tetra", "triangle"), 10: ("tetra10", "triangle6")}[mesh.cells.shape[1]]
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.cells_dict[kinds[0]], mesh.cells)
    groups = back.cell_data_dict["gmsh:physical"]
    assert np.array_equal(groups[kinds[0]], meshes.FIRST + mesh.phase)
    assert {name: data.tolist() for name, data in back.field_data.items()} == {
        **{name: [number, 2] for number, name in meshes.FACES.values()},
        "phase0": [11, 3],
        "phase1": [12, 3],
    }
    for name, (number, _) in meshes.FACES.items():
        mine = groups[kinds[1]] == number
        assert np.array_equal(back.cells_dict[kinds[1]][mine], mesh.walls[name].triangles)


def test_medit(tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = meshes.conforming(given.scene("sphere 10"), size=SIZE)
    meshes.write_medit(tmp_path / "body.mesh", mesh)
    back = meshio.read(tmp_path / "body.mesh")
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.cells_dict["tetra"], mesh.cells)
    assert np.array_equal(back.cell_data_dict["medit:ref"]["tetra"], meshes.FIRST + mesh.phase)
    counts = [np.sum(back.cell_data_dict["medit:ref"]["triangle"] == number) for number, _ in meshes.FACES.values()]
    assert counts == [len(mesh.walls[name].triangles) for name in meshes.FACES]


def test_inp(mesh, tmp_path):
    meshio = pytest.importorskip("meshio")
    meshes.write_inp(tmp_path / "body.inp", mesh)
    # meshio knows the elements of solids, whose nodes are the same.
    (tmp_path / "solid.inp").write_text((tmp_path / "body.inp").read_text().replace("=DC3D", "=C3D"))
    back = meshio.read(tmp_path / "solid.inp")
    order = np.argsort(mesh.phase, kind="stable")
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(np.concatenate([block.data for block in back.cells]), mesh.cells[order])
    assert np.array_equal(np.sort(back.point_sets["XMIN"]), np.flatnonzero(mesh.points[:, 0] == 0))


def test_corners_leave_no_node_alone():
    mesh = meshes.conforming(given.scene("sphere 10"), size=SIZE, order=2)
    linear = meshes.corners(mesh)
    assert linear.cells.shape[1] == 4 and len(np.unique(linear.cells)) == len(linear.points)
    assert np.array_equal(linear.points[linear.cells], mesh.points[mesh.cells[:, :4]])
    for (a, b), middle in EDGE_COLUMN.items():
        ends = linear.points[linear.cells[:, [a, b]]].mean(axis=1)
        assert np.allclose(mesh.points[mesh.cells[:, middle]], ends, atol=1e-12)
    for name, wall in linear.walls.items():
        at = linear.points[wall.triangles][..., "xyz".index(name[0])]
        assert np.all(at == (name[1] == "+"))


def test_pores_are_no_elements():
    mesh = meshes.conforming(given.scene("pore"), size=SIZE)
    assert set(mesh.phase.tolist()) == {0}
    assert len(np.unique(mesh.cells)) == len(mesh.points)
    assert np.allclose(volumes_of(mesh.points[mesh.cells]), mesh.volumes)


def test_energy_and_heat_of_what_is_known():
    """Drop 2 K, area 6 m2, length 0.5 m, 3 W/(m K): 72 W, and 144 W K."""
    from demheat import Material, Scene

    scene = Scene((0.5, 2.0, 3.0), Material(3.0), walls={"x-": 5.0, "x+": 3.0})
    assert meshes.by_heat(scene, 72.0) == pytest.approx(3.0)
    assert meshes.by_energy(scene, 144.0) == pytest.approx(3.0)
