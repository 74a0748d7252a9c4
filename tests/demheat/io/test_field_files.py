"""Only here: files, pictures and tables of fields in another order, without their mesh, or half written."""

import copy
import json
import pickle
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Field, Layer, Material, Samples, Scene, gallery
from demheat.io import packings
from demheat.terminal import pictures
from references import exact, fem

DTYPES = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "|u1"}
BOX = Scene((1.0, 2.0, 0.5), Material(2.0), [Layer(0, 0.25, 0.75, Material(4.0))], walls={"x-": 0.0, "x+": 1.0})


def arrays(path):
    """Arrays of a VTK file by their names, read without VTK; and its text."""
    head, _, data = path.read_bytes().partition(b'<AppendedData encoding="raw">\n_')
    text, found = head.decode(), {}
    for kind, name, width, offset in re.findall(
        r'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)" format="appended" offset="(\d+)"/>', text
    ):
        start = int(offset) + 8
        length = int.from_bytes(data[start - 8 : start], "little")
        found[name] = np.frombuffer(data[start : start + length], DTYPES[kind]).reshape(-1, int(width)).squeeze()
    return found, text


@pytest.fixture(scope="module")
def field():
    return exact.solve(BOX, points_per_axis=4)


def test_a_grid_has_the_voxels_of_the_field(field, tmp_path):
    field.write(tmp_path / "field.vti")
    found, text = arrays(tmp_path / "field.vti")
    counts = [int(word) for word in re.search(r'WholeExtent="0 (\d+) 0 (\d+) 0 (\d+)"', text).groups()]
    spacing = [float(word) for word in re.search(r'Spacing="(.*?)"', text)[1].split()]
    assert np.prod(counts) == len(field.samples.points) == len(found["temperature"])
    assert_allclose(np.multiply(counts, spacing), BOX.size, rtol=1e-15)
    # x runs fastest.
    middles = [(np.arange(n) + 0.5) * step for n, step in zip(counts, spacing, strict=True)]
    z, y, x = (axis.ravel() for axis in np.meshgrid(*middles[::-1], indexing="ij"))
    assert_allclose(found["temperature"], field.temperature_at(np.column_stack([x, y, z])), rtol=1e-12)
    assert_allclose(found["flux"], field.flux_at(np.column_stack([x, y, z])), rtol=1e-12, atol=1e-12)
    assert np.array_equal(found["phase"], BOX.phase_at(np.column_stack([x, y, z])))


def test_a_field_without_voxels_is_evaluated_on_a_grid(field, tmp_path):
    own = field.samples
    loose = Samples(own.points[1:], *(column[1:] for column in own[1:]))
    functions = {"sampler": lambda: loose, "temperature_at": field.temperature_at, "flux_at": field.flux_at}
    made = Field(BOX, field.mean_flux, field.fractions, **functions, wall_temperature=field.wall_temperature)
    made.write(tmp_path / "field.vti", cells=10)
    found, text = arrays(tmp_path / "field.vti")
    assert 'WholeExtent="0 5 0 10 0 2"' in text
    # Temperatures of 5 cells along x at their middles, the same along y and z: that of the layer rises half as fast.
    along = np.interp([0.1, 0.3, 0.5, 0.7, 0.9], [0, 0.25, 0.75, 1], [0, 1 / 3, 2 / 3, 1])
    assert_allclose(found["temperature"].reshape(2, 10, 5), np.broadcast_to(along, (2, 10, 5)), rtol=1e-12)


def test_outside_of_a_round_body_there_is_nothing(tmp_path):
    scene = Scene((1.0, 1.0, 1.0), Material(1.0), walls={"round": 0.0}, initial=1.0, domain="sphere")
    samples = Samples(np.diag([0.4, 0.5, 0.6]), np.ones(3), np.ones(3), np.zeros(3, int), np.zeros((3, 3)))
    functions = (lambda: samples, lambda points: np.ones(len(points)), lambda points: np.zeros((len(points), 3)))
    made = Field(scene, np.zeros(3), np.ones(1), *functions, time=0.0)
    made.write(tmp_path / "field.vti", cells=9)
    # Of the cells with their middles in the sphere; as many as make up its volume, to a tenth.
    share = np.isfinite(arrays(tmp_path / "field.vti")[0]["temperature"]).mean()
    assert abs(share / (np.pi / 6) - 1) < 0.1


def test_samples_are_points_with_radii(field, tmp_path):
    field.write(tmp_path / "field.vtp")
    found, _ = arrays(tmp_path / "field.vtp")
    for name in ("temperature", "flux", "phase"):
        assert np.array_equal(found[name], getattr(field.samples, name))
    # As ParaView's reader, and that of packings here.
    read = packings.read(tmp_path / "field.vtp", size=BOX.size)
    assert np.array_equal(read.centers, field.samples.points)
    assert_allclose((4 / 3 * np.pi * read.radii**3).sum(), 1.0, rtol=1e-12)


def test_finite_elements_have_their_mesh(tmp_path):
    meshio = pytest.importorskip("meshio")
    try:
        solved = fem.solve(BOX, size=0.5)
    except ImportError as error:
        pytest.skip(str(error))
    solved.write(tmp_path / "field.vtu")
    read = meshio.read(tmp_path / "field.vtu")
    (block,) = read.cells
    assert block.type == "tetra10" and len(block.data) == solved.stats["elements"]
    # Layers are exact, to the solver's tolerance.
    along = np.interp(read.points[:, 0], [0, 0.25, 0.75, 1], [0, 1 / 3, 2 / 3, 1])
    assert_allclose(np.ravel(read.point_data["temperature"]), along, atol=1e-8)
    assert_allclose(read.cell_data["flux"][0][:, 0], -8 / 3, rtol=1e-7)
    middles = read.points[block.data[:, :4]].mean(axis=1)
    assert np.array_equal(np.ravel(read.cell_data["phase"][0]), BOX.phase_at(middles))
    # Edges' middles lie between their corners, in VTK's order.
    for k, (a, b) in enumerate([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)], start=4):
        corners = read.points[block.data[:, a]] + read.points[block.data[:, b]]
        assert_allclose(read.points[block.data[:, k]], corners / 2, atol=1e-12)


def test_without_a_mesh_the_grid_is_written_as_hexahedra(field, tmp_path):
    field.write(tmp_path / "field.vtu")
    field.write(tmp_path / "field.xdmf")
    found, text = arrays(tmp_path / "field.vtu")
    assert set(found["types"]) == {12} and f'NumberOfCells="{len(field.samples.points)}"' in text
    corners = found["Points"][found["connectivity"].reshape(-1, 8)]
    # VTK's order: round the lower face, then the upper one.
    lower = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    edges = corners.max(axis=1, keepdims=True) - corners.min(axis=1, keepdims=True)
    order = np.array([*lower, *((x, y, 1) for x, y, _ in lower)])
    assert_allclose(corners, corners.min(axis=1, keepdims=True) + order * edges, atol=1e-12)
    assert_allclose(found["temperature"], field.temperature_at(corners.mean(axis=1)), rtol=1e-12)
    # The same as text, to the twelve digits of it.
    items = items_of(tmp_path / "field.xdmf")
    assert np.array_equal(items["Topology"].astype(int), found["connectivity"].reshape(-1, 8))
    assert_allclose(items["Geometry"], found["Points"], rtol=1e-11, atol=1e-15)
    for name in ("temperature", "flux", "phase"):
        assert_allclose(items[name], found[name], rtol=1e-11, atol=1e-11)


def items_of(path):
    """Arrays of an XDMF by their names, or what they are."""
    (grid,) = ElementTree.parse(path).getroot().iter("Grid")
    found = {}
    for each in grid:
        item = each.find("DataItem")
        shape = [int(word) for word in item.get("Dimensions").split()]
        found[each.get("Name") or each.tag] = np.array(item.text.split(), float).reshape(shape)
    return found


def test_a_folder_that_cannot_be_written_into_is_named_with_the_file(field, tmp_path, monkeypatch):
    monkeypatch.setattr("demheat.runtime.paths._takes_files", lambda _: False)
    with pytest.raises(ValueError, match=r"path = '.*field.npz': must lie in a folder that can be written into"):
        field.write(tmp_path / "field.npz")
    monkeypatch.undo()
    (tmp_path / "field.npz").mkdir()
    with pytest.raises(ValueError, match=r"field.npz': is a folder; must be the name of a file"):
        field.write(tmp_path / "field.npz")


def test_arrays_hold_all_numbers(field, tmp_path):
    field.write(tmp_path / "field.npz")
    with np.load(tmp_path / "field.npz", allow_pickle=False) as stored:
        for name, column in field.samples._asdict().items():
            assert np.array_equal(stored[name], column)
        assert float(stored["conductivity"]) == field.conductivity
        assert json.loads(str(stored["wall_heat"])) == dict(field.wall_heat)
        assert "time" not in stored
    with_time = replace(field, time=2.5)
    with_time.write(tmp_path / "field.npz")
    with np.load(tmp_path / "field.npz") as stored:
        assert float(stored["time"]) == 2.5


def test_what_cannot_be_written_says_what_can(field, tmp_path):
    with pytest.raises(ValueError, match="the suffix must be one of .vtp, .vti, .vtu, .xdmf, .npz"):
        field.write(tmp_path / "field.vtk")
    with pytest.raises(ValueError, match="cells = 0: must be an integer >= 1"):
        field.write(tmp_path / "field.vti", cells=0)
    with pytest.raises(ValueError, match="path = 5: must be the name of a file"):
        field.write(5)
    assert list(tmp_path.iterdir()) == []


def test_an_old_file_stays_if_writing_fails(field, tmp_path):
    (tmp_path / "field.vtp").write_text("old")

    def broken():
        raise RuntimeError("no samples")

    with pytest.raises(RuntimeError, match="no samples"):
        Field(BOX, field.mean_flux, field.fractions, broken, None, None).write(tmp_path / "field.vtp")
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("field.vtp", "old")]


def test_a_stored_field_keeps_the_error_that_was_asked_for(field):
    fresh = exact.solve(BOX, points_per_axis=4)
    with pytest.raises(NotImplementedError, match="Field.error: a stored field"):
        pickle.loads(pickle.dumps(fresh)).error  # noqa: B018
    assert pickle.loads(pickle.dumps(field)).conductivity == field.conductivity
    error = fresh.error
    twice = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(fresh))))
    assert twice.error == error
    with pytest.raises(NotImplementedError, match="Field.heat_through: a stored field"):
        twice.heat_through(0, 0.5)
    # In memory nothing is lost.
    assert copy.deepcopy(fresh) is fresh and copy.copy(fresh) is fresh


def test_pores_of_a_stored_field_stay_without_temperature():
    scene = replace(BOX, inclusions=[Layer(1, 0.5, 1.0, Material(0.0))])
    solved = exact.solve(scene, points_per_axis=4)
    again = pickle.loads(pickle.dumps(solved))
    assert np.isnan(again.samples.temperature).sum() == np.isnan(solved.samples.temperature).sum() > 0


def test_short_words(field):
    fresh = exact.solve(BOX, points_per_axis=4)
    # Half of the length conducts twice as well.
    assert repr(fresh) == "Field(conductivity: 2.66667 W/(m K), unknowns: 3)"
    assert "<th>conductivity</th><td>2.66667 W/(m K)</td>" in fresh._repr_html_()
    fresh.error  # noqa: B018
    assert "expected: 2.66667 to 2.66667 W/(m K)" in repr(fresh)
    bare = Field(replace(BOX, walls={"x-": 1.0}), np.ones(3), np.ones(2), None, None, None, time=2.0)
    assert repr(bare) == "Field(mean flux: (1, 1, 1) W/m2, time: 2 s)"
    assert "<td>1 layer</td>" in BOX._repr_html_() and "2, 4 W/(m K)" in BOX._repr_html_()
    heated = Scene((1, 1, 1), Material(1.0), initial=0.0)
    assert "<table>" in heated._repr_html_()


def test_pictures(field):
    """Pixels have the colour of their conductivity, and planes the field's temperature."""
    figure = BOX.plot(pixels=20)
    images = [panel.images[0].get_array() for panel in figure.axes[:3]]
    assert [image.shape for image in images] == [(5, 20), (10, 20), (20, 10)]
    # Across x the whole plane lies in the layer, the second conductivity; across y its half.
    assert np.all(images[0] == 1) and np.mean(images[1]) == 0.5
    assert [word.get_text() for word in figure.axes[3].get_yticklabels()] == ["2", "4"]
    figure = field.plot(pixels=8)
    values = figure.axes[0].images[0].get_array()
    assert values.shape == (8, 4)
    assert_allclose(values[0], np.interp([0.125, 0.375, 0.625, 0.875], [0, 0.25, 0.75, 1], [0, 1 / 3, 2 / 3, 1]))
    assert_allclose(figure.axes[1].images[0].get_array(), 8 / 3)
    # Of walls nobody knows the scale; under a mean gradient only differences count.
    assert [axes.get_ylabel() for axes in figure.axes[2:]] == ["temperature, K or C", "size of the flux, W/m2"]
    cell = Scene(BOX.size, Material(1.0), gradient=(1.0, 0.0, 0.0))
    assert exact.solve(cell, points_per_axis=3).plot(pixels=3).axes[2].get_ylabel() == "temperature, K"
    assert field.plot(axis=0, at=0.1, pixels=4).axes[0].get_xlabel() == "y, m"
    for wrong in ({"axis": 3}, {"at": 5.0}, {"at": "a"}, {"pixels": 0}):
        with pytest.raises(ValueError, match="must be"):
            field.plot(**wrong)
    with pytest.raises(ValueError, match="pixels = 0: must be"):
        BOX.plot(pixels=0)


def test_a_plane_that_is_as_warm_everywhere_has_a_scale():
    """Its digits of rounding had labels of twenty characters."""
    low, top = pictures._ends(30.0, 30.0 + 2e-14)
    assert 29 < low < 30 - 0.1 and 30.1 < top < 31
    assert pictures._ends(0.0, 0.0) == (-0.01, 0.01) and pictures._ends(1.0, 1.1) == (1.0, 1.1)


def test_many_conductivities_share_a_scale():
    k = np.linspace(1, 2, 12)
    layers = [Layer(0, n / 12, (n + 1) / 12, Material(float(each))) for n, each in enumerate(k)]
    scene = Scene((1, 1, 1), Material(1.0), layers, gradient=(0, 0, 1.0))
    image = scene.plot(pixels=12).axes[1].images[0]
    assert_allclose(image.get_array()[0], k)
    # Under a gradient along z a plane across y shows it.
    assert exact.solve(scene, points_per_axis=3).plot(pixels=3).axes[0].get_ylabel() == "z, m"


def test_the_matrix_is_grey_whatever_it_conducts():
    figure = gallery.sphere_in_cube(0.1).plot(pixels=9)
    values = figure.axes[0].images[0].get_array()
    assert values[0, 0] == 0 and values[4, 4] == 1
