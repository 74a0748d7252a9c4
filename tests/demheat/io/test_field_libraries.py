"""Fields handed to pandas, xarray and PyVista: numbers and coordinates are those of the field."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Field, Layer, Material, Samples, Scene
from references import exact, fem

BOX = Scene((1.0, 2.0, 0.5), Material(2.0), [Layer(0, 0.25, 0.75, Material(4.0))], walls={"x-": 0.0, "x+": 1.0})


@pytest.fixture(scope="module")
def pandas():
    return pytest.importorskip("pandas")


@pytest.fixture(scope="module", autouse=True)
def xarray():
    return pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def field():
    return exact.solve(BOX, points_per_axis=4)


def test_samples_are_rows(field, pandas):
    own, table = field.samples, field.to_dataframe()
    assert list(table) == ["x", "y", "z", "volume", "temperature", "phase", "flux_x", "flux_y", "flux_z"]
    assert np.array_equal(table[["x", "y", "z"]], own.points) and np.array_equal(table["temperature"], own.temperature)
    assert np.array_equal(table[["flux_x", "flux_y", "flux_z"]], own.flux)
    assert table["phase"].dtype == own.phase.dtype
    pandas.testing.assert_frame_equal(table, pandas.DataFrame(own.columns()))
    # Of the layer, half of the body.
    assert_allclose(table.groupby("phase")["volume"].sum() / BOX.volume, [0.5, 0.5], rtol=1e-12)


def test_a_grid_has_coordinates(field):
    grid = field.to_xarray()
    assert grid.sizes == {"x": 4, "y": 4, "z": 4, "component": 3} and grid["x"].attrs["units"] == "m"
    at = grid.sel(x=0.3, y=1.1, z=0.1, method="nearest")
    point = [[float(at[axis]) for axis in "xyz"]]
    assert_allclose(at["temperature"], field.temperature_at(point)[0], rtol=1e-12)
    assert_allclose(at["flux"], field.flux_at(point)[0], rtol=1e-12, atol=1e-12)
    assert int(at["phase"]) == BOX.phase_at(np.array(point))[0]
    assert grid["flux"].sel(component="x").shape == (4, 4, 4) and "time" not in grid.attrs


def test_what_has_no_voxels_is_evaluated(field):
    own = field.samples
    loose = Samples(own.points[1:], *(column[1:] for column in own[1:]))
    functions = {"sampler": lambda: loose, "temperature_at": field.temperature_at, "flux_at": field.flux_at}
    made = Field(BOX, field.mean_flux, field.fractions, **functions, wall_temperature=field.wall_temperature)
    grid = made.to_xarray(cells=10)
    assert grid["temperature"].shape == (5, 10, 2)
    # The layer's temperature rises half as fast.
    along = np.interp([0.1, 0.3, 0.5, 0.7, 0.9], [0, 0.25, 0.75, 1], [0, 1 / 3, 2 / 3, 1])
    assert_allclose(grid["temperature"].mean(("y", "z")), along, rtol=1e-12)
    with pytest.raises(ValueError, match="cells = 0: must be an integer >= 1"):
        made.to_xarray(cells=0)


def test_a_stored_field_answers_what_it_can(field, pandas):
    """All that its samples tell; what lies between them it says it has not."""
    again = pickle.loads(pickle.dumps(field))
    assert again.conductivity == field.conductivity and hash(again.scene) == hash(field.scene)
    pandas.testing.assert_frame_equal(again.to_dataframe(), field.to_dataframe())
    assert again.to_xarray().identical(field.to_xarray())
    with pytest.raises(NotImplementedError, match="a stored field has its samples and conductivity"):
        again.temperature_at([[0.1, 0.1, 0.1]])


class Reader:
    """What stands for PyVista: keeps the path's suffix and text that it is asked to read."""

    def read(self, path):
        return path.suffix, path.read_bytes()


@pytest.mark.parametrize("kind", [".vti", ".vtp", ".vtu"])
def test_pyvista_reads_what_is_written(kind, field, monkeypatch, tmp_path):
    import sys

    if kind == ".vtp":
        own = field.samples
        loose = Samples(own.points[1:], *(column[1:] for column in own[1:]))
        functions = {"sampler": lambda: loose, "temperature_at": field.temperature_at, "flux_at": field.flux_at}
        field = Field(BOX, field.mean_flux, field.fractions, **functions, wall_temperature=field.wall_temperature)
    elif kind == ".vtu":
        try:
            field = fem.solve(BOX, size=0.5)
        except ImportError as error:
            pytest.skip(str(error))
    monkeypatch.setitem(sys.modules, "pyvista", Reader())
    suffix, text = field.to_pyvista()
    field.write(tmp_path / f"field{kind}")
    assert suffix == kind and text == (tmp_path / f"field{kind}").read_bytes()
