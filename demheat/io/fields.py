"""Fields as files: for ParaView (.vtp, .vti, .vtu) and for NumPy (.npz).

======  ==================================================================================================
suffix  what is in it
======  ==================================================================================================
.vtp    the method's own samples as points: particles, voxels or quadrature points, with the radius of a sphere of their
        volume; of every method
.vti    temperature, flux and phase on a regular grid: the voxels of a method that has them, else `cells` of them
        along the longest side, at their middles; of every method
.vtu    the mesh with the temperature at its nodes; of finite elements
.npz    samples, conductivity and what else a field holds, as plain arrays
======  ==================================================================================================
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from demheat.field import Field, check_field
from demheat.io.vtk import Blocks, put_down
from demheat.runtime.limits import check_memory
from demheat.runtime.paths import checked_path, replaced
from demheat.scene.bodies import inside
from demheat.scene.inputs import whole

# Tetrahedra of so many nodes, by VTK's number; their order of nodes is VTK's.
TETRAHEDRA = {4: 10, 10: 24}
# Bytes of a cell of a grid while it is made.
BYTES = 120


def write(field: Field, path, *, cells: int = 64) -> None:
    """Write into a file for ParaView (.vtp, .vti, .vtu) or NumPy (.npz), see `demheat.io.fields`.

    An interrupted write leaves no file, and an old one as it was.

    Parameters
    ----------
    path : path
    cells : int
        Of a .vti, along the longest side, where the field has no voxels of its own.
    """
    check_field(field)
    path = check_target(path, mesh=getattr(field, "elements", None) is not None)
    whole("cells", cells, "an integer >= 1", lambda v: v >= 1)
    make = WRITERS[path.suffix.lower()]
    with replaced(path) as part, part.open("xb") as stream:
        make(field, stream, cells)


def check_target(path, *, mesh: bool) -> Path:
    """The path of a file that a field can be written to, before anything is solved."""
    path = checked_path(path)
    if path.suffix.lower() not in WRITERS:
        raise ValueError(f"path = {str(path)!r}: the suffix must be one of {', '.join(WRITERS)}")
    if not path.parent.is_dir():
        raise ValueError(f"path = {str(path)!r}: there is no folder {str(path.parent)!r}")
    if path.suffix.lower() == ".vtu" and not mesh:
        raise NotImplementedError(
            f"path = {str(path)!r}: this field has no mesh; only finite elements around shapes have, of an image they "
            "are its voxels. Use .vti for a grid, or .vtp for its own points"
        )
    return path


def _points(field, stream, cells):
    own = field.samples
    blocks = Blocks()
    data = {"radius": np.cbrt(3 * own.volumes / (4 * math.pi)), "volume": own.volumes}
    data |= {"temperature": own.temperature, "flux": own.flux, "phase": own.phase}
    count = len(own.volumes)
    parts = (
        f'<Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" '
        f'NumberOfPolys="0"><PointData Scalars="temperature">{blocks.add_all(data)}</PointData><Points>'
        f"{blocks.add('Points', own.points)}</Points><Verts>{blocks.cells(np.arange(count)[:, None])}</Verts>"
    )
    put_down(stream, "PolyData", parts, blocks.arrays)


def _grid(field, stream, cells):
    shape, data = grid_of(field, cells)
    blocks = Blocks()
    extent = " ".join(f"0 {count}" for count in shape)
    spacing = " ".join(repr(side / count) for side, count in zip(field.scene.size, shape, strict=True))
    data = blocks.add_all({name: _x_first(array, shape) for name, array in data.items()})
    parts = f'<Piece Extent="{extent}"><CellData Scalars="temperature">{data}</CellData>'
    more = f' WholeExtent="{extent}" Origin="0 0 0" Spacing="{spacing}"'
    put_down(stream, "ImageData", parts, blocks.arrays, more=more)


def grid_of(field: Field, cells: int) -> tuple[list[int], dict[str, np.ndarray]]:
    """Shape of a grid, and what a field has there, z fastest: its own voxels, else so many cells along the box."""
    return voxels_of(field) or _on_cells(field, cells)


def voxels_of(field: Field) -> tuple[list[int], dict[str, np.ndarray]] | None:
    """Shape of the grid that a field's own samples are on, and what is there; None if they are on none."""
    own, size = field.samples, np.array(field.scene.size)
    shape = [len(np.unique(np.round(own.points[:, axis] / size[axis], 9))) for axis in range(3)]
    if math.prod(shape) != len(own.points):
        return None
    place = np.floor(own.points / size * shape).astype(int)
    # To the rounding of coordinates.
    if not np.allclose(own.points, (place + 0.5) / shape * size, rtol=0, atol=1e-9 * size.max()):
        return None
    order = np.lexsort(place.T[::-1])
    return shape, {"temperature": own.temperature[order], "flux": own.flux[order], "phase": own.phase[order]}


def _on_cells(field, cells):
    """Shape of a grid of nearly cubic cells, and what the field has at their middles."""
    scene = field.scene
    size = np.array(scene.size)
    shape = np.maximum(np.round(size / size.max() * cells), 1).astype(int)
    check_memory("cells", cells, BYTES * float(np.prod(shape.astype(float))), power=3)
    middles = [(np.arange(count) + 0.5) / count * side for count, side in zip(shape, size, strict=True)]
    points = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 3)
    within = inside(points, scene.domain, scene.size)
    temperature, flux = np.full(len(points), np.nan), np.full((len(points), 3), np.nan)
    temperature[within], flux[within] = field.temperature_at(points[within]), field.flux_at(points[within])
    return shape, {"temperature": temperature, "flux": flux, "phase": scene.phase_at(points)}


def _x_first(array, shape):
    """In VTK's order: x runs fastest."""
    return array.reshape(*shape, -1).transpose(2, 1, 0, 3).reshape(array.shape)


def _mesh(field, stream, cells):
    nodes, tetrahedra = field.elements()
    blocks = Blocks()
    middles = nodes[tetrahedra[:, :4]].mean(axis=1)
    kinds = np.full(len(tetrahedra), TETRAHEDRA[tetrahedra.shape[1]], np.uint8)
    points = blocks.add("temperature", field.temperature_at(nodes))
    inner = blocks.add_all({"flux": field.flux_at(middles), "phase": field.scene.phase_at(middles)})
    parts = (
        f'<Piece NumberOfPoints="{len(nodes)}" NumberOfCells="{len(tetrahedra)}"><PointData Scalars="temperature">'
        f"{points}</PointData><CellData>{inner}</CellData><Points>{blocks.add('Points', nodes)}</Points><Cells>"
        f"{blocks.cells(tetrahedra)}{blocks.add('types', kinds)}</Cells>"
    )
    put_down(stream, "UnstructuredGrid", parts, blocks.arrays)


def _arrays(field, stream, cells):
    """Without pickled objects: what is no number is text as JSON."""
    told = {name: value for name, value in field.stats.items() if isinstance(value, (bool, int, float, str))}
    arrays = {**field.samples._asdict(), "mean_flux": field.mean_flux, "fractions": field.fractions}
    arrays |= {"size": np.array(field.scene.size), "stats": json.dumps(told)}
    for name in ("wall_temperature", "wall_heat"):
        arrays[name] = json.dumps(dict(getattr(field, name)))
    try:
        arrays["conductivity"] = np.array(field.conductivity)
    except ValueError:
        pass
    if field.time is not None:
        arrays["time"] = np.array(field.time)
    np.savez(stream, **arrays)


WRITERS = {".vtp": _points, ".vti": _grid, ".vtu": _mesh, ".npz": _arrays}
