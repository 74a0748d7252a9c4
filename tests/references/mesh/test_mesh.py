"""Meshes of boxes with spheres and layers: phases, pairs of faces, sizes in gaps, curved elements that are sound."""

import ctypes
import importlib
import math

import numpy as np
import pytest
from meshed_here import gmsh_or_skip, mesh_here
from numpy.testing import assert_allclose

from demheat.scene import Layer, Material, Scene, Sphere
from references import mesh
from references.mesh import cad, gmsh_session
from references.mesh.cells import bent, check, jacobian_coefficients, snap, straighten, volumes_of
from references.mesh.sizes import checked_size, wanted_sizes

ROCK, METAL = Material(1.0), Material(10.0)
WALLS = {"y-": 0.0, "y+": 1.0}


@pytest.fixture(autouse=True)
def with_gmsh(request):
    if "missing" not in request.node.name:
        gmsh_or_skip()


def scene(*inclusions, size=(1.0, 1.0, 1.0), **load):
    return Scene(size=size, matrix=ROCK, inclusions=inclusions, **(load or {"walls": WALLS}))


def ball(center=(0.5, 0.5, 0.5), radius=1 / 3, material=METAL):
    return Sphere(center, radius, material)


def fractions(made, of):
    return np.bincount(made.phase, made.volumes, len(of.materials)) / of.volume


def areas(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.mark.parametrize(
    ("order", "curved", "low", "high"), [(1, True, 0.9, 0.99), (2, False, 0.9, 0.99), (2, True, 0.9995, 1)]
)
def test_volumes_fill_the_box_and_curved_elements_the_sphere(order, curved, low, high):
    of = scene(ball(), size=(1.0, 0.9, 1.2))
    made = mesh.make(of, order=order, size=0.12, curved=curved)
    assert made.cells.shape[1] == (4 if order == 1 else 10)
    assert_allclose(made.volumes.sum(), of.volume, rtol=1e-12)  # rounding of 1e4 sums
    # Chords lie inside: straight facets of edge h lose about (h/R)^2/4 = 3 %, quadratic ones (h/R)^4/40 = 4e-4.
    ratio = fractions(made, of)[1] * of.volume / (4 * math.pi / 81)
    assert low < ratio < high
    assert made.curved.any() == (order == 2 and curved)
    for name, (triangles, owners) in made.walls.items():
        axis = "xyz".index(name[0])
        assert_allclose(areas(made.points, triangles).sum(), of.volume / of.size[axis], rtol=1e-12)
        assert np.all(made.points[triangles][..., axis] == (0.0 if name[1] == "-" else of.size[axis]))
        assert all(set(t) <= set(made.cells[o]) for t, o in zip(triangles[:20], owners[:20], strict=True))


def test_phases_of_nested_cut_and_layered_inclusions():
    layer = Layer(0, 0.6, 1.0, Material(2.0))
    shell, core = ball((0.25, 0.5, 0.5), 0.2), ball((0.25, 0.5, 0.55), 0.1, Material(3.0))
    cap = ball((0.8, 0.1, 0.5), 0.15, Material(4.0))
    of = scene(layer, shell, core, cap)
    made = mesh.make(of, size=0.1)
    found = fractions(made, of)
    height = 0.15 + 0.1  # of the part inside the box
    volumes = [0.4, 0.2**3 * 4 / 3 * math.pi, 0.1**3 * 4 / 3 * math.pi, math.pi * height**2 * (0.15 - height / 3)]
    volumes[0] -= volumes[3]
    volumes[1] -= volumes[2]
    # Quadratic facets of edge 0.33 R lose (h/R)^4/40, three parts in 1e4; the layer's plane faces lose nothing.
    assert_allclose(found[1:], volumes, rtol=1e-3)
    inside = made.points[made.cells[:, :4]].mean(axis=1)
    assert np.mean(of.phase_at(inside) == made.phase) > 0.99  # but for chords


def test_a_sphere_across_periodic_faces_is_whole_and_faces_match():
    of = scene(ball((0.05, 0.98, 0.5)), gradient=(1.0, 0.0, 0.0), size=(1.0, 1.25, 0.9))
    made = mesh.make(of, size=0.12)
    assert_allclose(fractions(made, of)[1] * of.volume, 4 * math.pi / 81, rtol=1e-3)  # as above
    high, low = made.pairs.T
    shift = made.points[high] - made.points[low]
    assert np.all(np.sum(shift != 0, axis=1) == 1)
    assert set(map(tuple, np.unique(shift, axis=0))) == {(1.0, 0, 0), (0, 1.25, 0), (0, 0, 0.9)}
    for axis, length in enumerate(of.size):
        assert np.sum(made.points[:, axis] == length) == np.sum(shift[:, axis] != 0)
    twin = mesh.twins(len(made.points), made.pairs)
    corners = np.all((made.points == 0) | (made.points == of.size), axis=1)
    assert len(set(twin[corners])) == 1 and corners.sum() == 8
    assert np.all(made.points[twin] < of.size)


# A corner is cut by three pairs of faces, and is what fails first.
@pytest.mark.parametrize(
    "center", [(0.0, 0.0, 0.0), *(pytest.param(c, marks=pytest.mark.slow) for c in ((0.5, 0.5, 0.0), (0.5, 0.0, 0.0)))]
)
def test_spheres_centred_on_corner_edge_and_face(center):
    of = scene(ball(center), gradient=(0.0, 1.0, 0.0))
    assert_allclose(fractions(mesh.make(of, size=0.15), of)[1], 4 * math.pi / 81, rtol=2e-3)  # (h/R)^4/40 at 0.45


def test_layers_that_touch_but_for_rounding():
    layers = [Layer(2, 0.0, 0.3, METAL), Layer(2, 0.3 + 1e-13, 0.6, ROCK), Layer(2, 0.6 - 1e-13, 1 + 5e-13, METAL)]
    of = scene(*layers)
    assert_allclose(fractions(mesh.make(of, size=0.4), of), [0, 0.3, 0.3, 0.4], atol=1e-11)  # twice that rounding


def test_narrow_gaps_get_finer_elements_and_stay_valid():
    of = scene(ball((0.5, 0.5, 0.25), 0.245), ball((0.5, 0.5, 0.745), 0.245))
    made = mesh.make(of, size=0.15)
    centers = made.points[made.cells[:, :4]].mean(axis=1)
    for gap in ((0.5, 0.5, 0.0025), (0.5, 0.5, 0.4975), (0.5, 0.5, 0.995)):
        near = np.linalg.norm(centers - gap, axis=1) < 0.05
        # Wanted there: 0.5 sqrt(0.005 x 0.245) = 0.0175, whose tetrahedra have at most size^3/6; 0.15^3/6 = 5.6e-4.
        assert near.sum() > 20 and np.median(made.volumes[near]) < 0.0175**3
    assert made.stats["jacobian"] > 0.1 and made.volumes.min() > 0


def test_wanted_sizes_of_small_spheres_shells_layers_and_gaps():
    small, thin = ball((0.2, 0.2, 0.2), 0.03), Layer(2, 0.5, 0.52, METAL)
    outer, inner = ball((0.7, 0.7, 0.8), 0.15), ball((0.7, 0.7, 0.8), 0.149)
    sizes = wanted_sizes(scene(small, thin, outer, inner), 0.1)
    assert_allclose(sizes.balls[np.isclose(sizes.balls[:, 3], 0.03)][:, 4], [0.33 * 0.03])
    assert_allclose(sizes.slabs, [[2, 0.5, 0.52, 0.02]])
    assert_allclose(sizes.shells[:, 3:], [[0.149, 0.15, 0.003]])
    top = sizes.balls[np.all(np.isclose(sizes.balls[:, :3], (0.7, 0.7, 1.0)), axis=1)]  # under the face z+
    assert_allclose(top[:, 4], 0.5 * np.sqrt([0.05 * 0.15, 0.051 * 0.149]))


@pytest.mark.slow
def test_a_mesh_does_not_depend_on_the_unit_of_length_and_is_reproducible():
    unit = 2.0**-20  # a power of two: the same digits
    first = mesh.make(scene(ball()), size=0.15)
    second = mesh.make(scene(ball((0.5 * unit,) * 3, unit / 3), size=(unit,) * 3), size=0.15 * unit)
    assert np.array_equal(first.cells, second.cells)
    assert np.array_equal(first.points * unit, second.points)


def test_gmsh_is_silent_and_the_callers_is_left_alone(capfd):
    gmsh = mesh.load_gmsh()
    mesh.make(scene(ball()), size=0.25)
    assert not gmsh.isInitialized()
    assert capfd.readouterr() == ("", "")


def test_a_failed_size_is_tried_again_then_refused(monkeypatch):
    attempt, calls = cad._attempt, []

    def fails_once(of, sizes, *knobs):
        calls.append(sizes.size)
        if len(calls) == 1:
            raise Exception("no elements in volume 1")
        return attempt(of, sizes, *knobs)

    monkeypatch.setattr(cad, "_attempt", fails_once)
    made = mesh.make(scene(ball()), size=0.25)
    assert made.stats["attempts"] == 2 and made.stats["size"] == pytest.approx(0.93 * 0.25)
    assert calls == [0.25, pytest.approx(0.93 * 0.25)]

    def fails(*_):
        raise Exception("PLC Error")

    monkeypatch.setattr(cad, "_attempt", fails)
    with pytest.raises(RuntimeError, match="4 sizes.*0.25 m: PLC Error"):
        mesh.make(scene(ball()), size=0.25)


@pytest.mark.parametrize(
    "inclusions",
    [
        [ball((0.3, 0.5, 0.5), 0.2), ball((0.7, 0.5, 0.5), 0.2)],
        [ball(radius=0.5)],
        [ball(), ball((0.5, 0.5, 0.4), 1 / 3 - 0.1)],
        [Layer(0, 0.2, 0.8, METAL), ball((0.5, 0.5, 0.5), 0.3, ROCK)],
    ],
)
def test_touching_surfaces_are_refused(inclusions):
    with pytest.raises(NotImplementedError, match="touch") as told:
        mesh.make(scene(*inclusions), size=0.2)
    # Two spheres beside each other: one in the other, walls and layers would not be apart by that.
    assert ("radius_factor = 0.99" in str(told.value)) == (inclusions[-1].center == (0.7, 0.5, 0.5))


def test_wrong_geometry_is_noticed(monkeypatch):
    geometry = cad._cut_geometry
    monkeypatch.setattr(gmsh_session, "run_apart", mesh_here)
    monkeypatch.setattr(cad, "_cut_geometry", lambda *args: dict.fromkeys(geometry(*args), 0))
    with pytest.raises(RuntimeError, match="phase 1: .* misplaced"):
        mesh.make(scene(ball()), size=0.25)
    monkeypatch.undo()
    made = mesh.make(scene(), size=0.5)
    check(scene(), made)
    with pytest.raises(RuntimeError, match="phase 1, a sphere, was lost"):
        check(scene(ball((0.31, 0.52, 0.43), 1e-3)), made)
    with pytest.raises(RuntimeError, match="fill 0.9"):
        check(scene(), made._replace(volumes=made.volumes * 0.99))
    made.volumes[0] *= -1
    with pytest.raises(RuntimeError, match="1 inverted"):
        check(scene(), made)


def test_missing_system_libraries_are_named_with_their_packages(monkeypatch):
    library = ctypes.CDLL

    def load(name, *args, **kwargs):
        if name in ("libGLU.so.1", "libXft.so.2"):
            raise OSError(f"{name}: cannot open shared object file")
        return library(None)

    def imports(name):
        raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")

    monkeypatch.setattr(gmsh_session, "run_apart", lambda function, *arguments, **how: function(*arguments))
    monkeypatch.setattr(ctypes, "CDLL", load)
    monkeypatch.setattr(importlib, "import_module", imports)
    with pytest.raises(ImportError, match="libGLU.so.1, libXft.so.2.*apt-get install libglu1-mesa libxft2$"):
        mesh.make(scene(ball()))

    def absent(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(ImportError, match=r"pip install 'demheat\[fem\]'"):
        mesh.make(scene(ball()))


def reference_element():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    return np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in mesh.EDGE_COLUMN]])


def test_bernstein_coefficients_bound_the_jacobian_and_give_the_volume():
    rng = np.random.default_rng(0)
    nodes = reference_element() + 0.1 * rng.standard_normal((5, 10, 3))
    coefficients = jacobian_coefficients(nodes)
    # Midpoint rule on barycentric cells, by finite differences of the quadratic map.
    grid = np.array([(i, j, k) for i in range(40) for j in range(40 - i) for k in range(40 - i - j)])
    X = (grid + 0.25) / 40
    lam = np.column_stack([1 - X.sum(axis=1), X])

    def place(lam):
        shape = [lam[:, a] * (2 * lam[:, a] - 1) for a in range(4)]
        shape += [4 * lam[:, a] * lam[:, b] for a, b in mesh.EDGE_COLUMN]
        return np.einsum("np,mnx->mpx", np.array(shape), nodes)

    columns = []
    for k in (1, 2, 3):
        step = np.zeros(4)
        step[[0, k]] = -1e-4, 1e-4
        columns.append((place(lam + step) - place(lam - step)) / 2e-4)
    det = np.linalg.det(np.stack(columns, axis=-1))
    assert np.all(det >= coefficients.min(axis=1)[:, None] - 1e-9)  # rounding of the differences
    assert np.all(det <= coefficients.max(axis=1)[:, None] + 1e-9)
    # A mean over sample points, one-sided by a quarter of the spacing 1/40 towards the origin's corner: a few percent.
    assert_allclose(volumes_of(nodes), det.mean(axis=1) / 6, rtol=0.05)
    assert_allclose(volumes_of(reference_element()[None]), 1 / 6, rtol=1e-15)


def test_inverted_elements_and_their_periodic_twins_are_straightened():
    first = reference_element()
    first[4] += (0, 0.6, 0.6)  # the middle of edge 01 pushed through the element
    second = reference_element() + (2, 0, 0)
    points, cells = np.vstack([first, second]), np.arange(20).reshape(2, 10)
    assert jacobian_coefficients(points[cells]).min(axis=1)[0] < 0 and bent(points[cells]).tolist() == [True, False]
    points[14] += (0, 0.05, 0)  # the twin of that middle, itself harmless
    count, least = straighten(points, cells, np.array([[14, 4]]))
    assert count == 1 and least == 1.0
    assert_allclose(points, np.vstack([reference_element(), second]), atol=1e-15)


def test_default_size_follows_order_and_number_of_spheres():
    few, many = scene(ball()), scene(*(ball((x / 10, 0.5, 0.5), 0.01) for x in range(1, 10)), size=(2.0, 2.0, 2.0))
    assert checked_size(few, None, 2) == pytest.approx(1 / 26)
    assert checked_size(few, None, 1) == pytest.approx(1 / 50)
    assert checked_size(many, None, 2) == pytest.approx(2 / 26)
    grid = [(i / 5 - 0.1, j / 5 - 0.1, k / 5 - 0.1) for i in range(1, 6) for j in range(1, 6) for k in range(1, 6)]
    assert checked_size(scene(*(ball(c, 0.05) for c in grid)), None, 2) == pytest.approx(1 / 40)


def test_write_for_other_programs(tmp_path):
    meshio = pytest.importorskip("meshio")
    made = mesh.make(scene(ball()), size=0.25)

    class Linear:
        @staticmethod
        def temperature_at(points):
            return points[:, 0]

        @staticmethod
        def flux_at(points):
            return -points

    mesh.write(tmp_path / "scene.vtu", made, Linear)
    back = meshio.read(tmp_path / "scene.vtu")
    assert_allclose(back.points, made.points)
    assert np.array_equal(back.cells_dict["tetra10"], made.cells)
    assert np.array_equal(back.cell_data["phase"][0], made.phase)
    assert_allclose(back.point_data["temperature"], made.points[:, 0])
    assert_allclose(back.cell_data["flux"][0], -made.points[made.cells[:, :4]].mean(axis=1))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_nodes_of_opposite_faces_are_paired_or_refused(axis):
    corners = np.stack(np.meshgrid(*[(0.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    noise = np.random.default_rng(axis).uniform(-1e-10, 1e-10, corners.shape)
    points = corners + noise
    high, low = snap(points, np.ones(3), True).T
    assert np.array_equal(points, corners) and len(high) == 12
    assert np.array_equal(np.abs(points[high] - points[low]).sum(axis=1), np.ones(12))
    assert len(snap(corners + noise, np.ones(3), False)) == 0
    # One node of a face slid along it.
    points[-1, axis] -= 1e-3
    with pytest.raises(RuntimeError, match="opposite faces of the periodic cell do not match"):
        snap(points, np.ones(3), True)
