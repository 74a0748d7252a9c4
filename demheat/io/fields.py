"""Fields as files, of every method: for ParaView (.vtp, .vti, .vtu, .xdmf) and for NumPy (.npz).

======  ==================================================================================================
suffix  what is in it
======  ==================================================================================================
.vtp    the method's own samples as points: particles, voxels or quadrature points, with the radius of a sphere of their
        volume
.vti    temperature, flux and phase on a regular grid: the voxels of a method that has them, else `cells` of them
        along the longest side, at their middles
.vtu    the mesh with the temperature at its nodes, of finite elements; of others the grid as hexahedra
.xdmf   the same as plain text, which is some times as long
.npz    samples, conductivity and what else a field holds, as plain arrays
======  ==================================================================================================
"""

import json
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.field import Field, check_field
from demheat.io.vtk import Blocks, put_down
from demheat.runtime.limits import check_memory
from demheat.runtime.paths import check_target, replaced
from demheat.scene.bodies import inside
from demheat.scene.inputs import whole

# Elements of so many nodes, by VTK's number and XDMF's name; their order of nodes is that of both.
VTK = {4: 10, 8: 12, 10: 24}
XDMF = {4: "Tetrahedron", 8: "Hexahedron", 10: "Tetrahedron_10"}
# Corners of a hexahedron, along each axis.
HEXAHEDRON = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
# Bytes of a cell of a grid while it is made.
BYTES = 120


def write(field: Field, path, *, cells: int = 64) -> None:
    """Write into a file for ParaView (.vtp, .vti, .vtu, .xdmf) or NumPy (.npz), see `demheat.io.fields`.

    An interrupted write leaves no file, and an old one as it was.

    Parameters
    ----------
    path : path
    cells : int
        Of a grid, along the longest side, where the field has neither mesh nor voxels of its own.
    """
    check_field(field)
    path = field_target(path)
    whole("cells", cells, "an integer >= 1", lambda v: v >= 1)
    make = WRITERS[path.suffix.lower()]
    with replaced(path) as part, part.open("xb") as stream:
        make(field, stream, cells)


def field_target(path) -> Path:
    """The path of a file that a field can be written to, before anything is solved."""
    path = check_target(path)
    if path.suffix.lower() not in WRITERS:
        raise ValueError(f"path = {str(path)!r}: the suffix must be one of {', '.join(WRITERS)}")
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


class Elements(NamedTuple):
    """What is put on elements: tetrahedra of a mesh, else hexahedra of a grid."""

    nodes: np.ndarray  # (n, 3) float array, m
    cells: np.ndarray  # (m, 4, 8 or 10) int array
    at_nodes: dict  # Arrays by their names
    in_cells: dict


def _elements(field, cells):
    if getattr(field, "elements", None) is None:
        shape, data = grid_of(field, cells)
        return Elements(*_hexahedra(field.scene.size, shape), {}, data)
    nodes, tetrahedra = field.elements()
    middles = nodes[tetrahedra[:, :4]].mean(axis=1)
    inner = {"flux": field.flux_at(middles), "phase": field.scene.phase_at(middles)}
    return Elements(nodes, tetrahedra, {"temperature": field.temperature_at(nodes)}, inner)


def _hexahedra(size, shape):
    """Nodes and cells of a regular grid, the last axis fastest."""
    axes = [np.linspace(0.0, side, count + 1) for side, count in zip(size, shape, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    numbers = np.arange(len(nodes)).reshape([count + 1 for count in shape])
    step = np.array(numbers.strides) // numbers.itemsize
    return nodes, numbers[:-1, :-1, :-1].reshape(-1, 1) + HEXAHEDRON @ step


def _mesh(field, stream, cells):
    made, blocks = _elements(field, cells), Blocks()
    kinds = np.full(len(made.cells), VTK[made.cells.shape[1]], np.uint8)
    parts = (
        f'<Piece NumberOfPoints="{len(made.nodes)}" NumberOfCells="{len(kinds)}">'
        f"<PointData>{blocks.add_all(made.at_nodes)}</PointData><CellData>{blocks.add_all(made.in_cells)}</CellData>"
        f"<Points>{blocks.add('Points', made.nodes)}</Points><Cells>"
        f"{blocks.cells(made.cells)}{blocks.add('types', kinds)}</Cells>"
    )
    put_down(stream, "UnstructuredGrid", parts, blocks.arrays)


def _xdmf(field, stream, cells):
    """XDMF 3 as plain text, which needs no library and no second file (xdmf.org, model and format)."""
    made = _elements(field, cells)
    stream.write(b'<?xml version="1.0"?>\n<Xdmf Version="3.0"><Domain><Grid Name="field">\n')
    kind = f'<Topology TopologyType="{XDMF[made.cells.shape[1]]}" NumberOfElements="{len(made.cells)}">'
    _item(stream, kind, made.cells, "Topology")
    _item(stream, '<Geometry GeometryType="XYZ">', made.nodes, "Geometry")
    for center, arrays in (("Node", made.at_nodes), ("Cell", made.in_cells)):
        for name, array in arrays.items():
            rank = "Scalar" if array.ndim == 1 else "Vector"
            head = f'<Attribute Name="{name}" AttributeType="{rank}" Center="{center}">'
            _item(stream, head, array, "Attribute")
    stream.write(b"</Grid></Domain></Xdmf>\n")


def _item(stream, head, array, tail):
    """An array as text between two tags."""
    whole = array.dtype.kind != "f"
    sides = " ".join(map(str, array.shape))
    kind = 'DataType="Int" Precision="8"' if whole else 'DataType="Float" Precision="8"'
    stream.write(f'{head}<DataItem {kind} Dimensions="{sides}" Format="XML">\n'.encode())
    np.savetxt(stream, array, fmt="%d" if whole else "%.12g")
    stream.write(f"</DataItem></{tail}>\n".encode())


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


WRITERS = {".vtp": _points, ".vti": _grid, ".vtu": _mesh, ".xdmf": _xdmf, ".npz": _arrays}
