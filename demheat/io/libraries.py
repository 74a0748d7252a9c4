"""Fields for other libraries: tables of pandas, grids of xarray, what PyVista draws. Each library is an extra."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from demheat.field import Field, check_field
from demheat.io.fields import grid_of, voxels_of, write
from demheat.runtime.extras import extra
from demheat.scene.inputs import whole

if TYPE_CHECKING:
    from pandas import DataFrame
    from pyvista import DataSet
    from xarray import Dataset

UNITS = {"temperature": "K or degree_Celsius", "flux": "W/m2", "phase": "1"}


def to_dataframe(field: Field) -> DataFrame:
    """The method's own samples as a pandas.DataFrame, one row for each; its columns are those of `Samples.columns`.

    Raises
    ------
    ImportError
        Without pandas: ``pip install 'demheat[pandas]'``.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import exact
    >>> table = exact.solve(gallery.sphere_in_cube(5.0), points_per_axis=8).to_dataframe()
    >>> print(*table.columns, f"{table.temperature.mean():.3f}")
    x y z volume temperature phase flux_x flux_y flux_z 30.000
    """
    check_field(field)
    with extra("Field.to_dataframe"):
        import pandas

    return pandas.DataFrame(field.samples.columns())


def to_xarray(field: Field, *, cells: int = 64) -> Dataset:
    """Temperature, flux and phase on a regular grid as an xarray.Dataset; x, y and z are in metres.

    Parameters
    ----------
    cells : int
        Along the longest side, where the field has no voxels of its own. Beyond the body all is NaN but the phase.

    Raises
    ------
    ImportError
        Without xarray: ``pip install 'demheat[xarray]'``.
    """
    check_field(field)
    whole("cells", cells, "an integer >= 1", lambda v: v >= 1)
    with extra("Field.to_xarray"):
        import xarray

    shape, data = grid_of(field, cells)
    coords = {
        name: (name, (np.arange(count) + 0.5) / count * side, {"units": "m"})
        for name, count, side in zip("xyz", shape, field.scene.size, strict=True)
    }
    values = {
        name: (("x", "y", "z", "component")[: 2 + array.ndim], array.reshape(*shape, *array.shape[1:]), {"units": unit})
        for (name, array), unit in ((each, UNITS[each[0]]) for each in data.items())
    }
    told = {} if field.time is None else {"time": field.time, "time_units": "s"}
    return xarray.Dataset(values, coords=coords | {"component": list("xyz")}, attrs=told)


def to_pyvista(field: Field) -> DataSet:
    """What PyVista draws, as `write` has it: the mesh of finite elements, a grid of voxels, else the samples as points.

    Raises
    ------
    ImportError
        Without PyVista: ``pip install 'demheat[pyvista]'``.
    """
    check_field(field)
    with extra("Field.to_pyvista"):
        import pyvista

    suffix = ".vtu" if field.elements is not None else ".vti" if voxels_of(field) else ".vtp"
    # VTK's own reader makes of it what ParaView would see.
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"field{suffix}"
        write(field, path)
        return pyvista.read(path)
