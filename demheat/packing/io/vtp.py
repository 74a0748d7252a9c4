"""ParaView's PolyData (.vtp): points with radius, links as lines (docs.vtk.org, VTK XML file formats).

Written by hand: meshio has no PolyData; pyevtk, looked at in version 1.7.0, writes vectors one number at a time in
Python and leaves the number of tuples out of field data, which VTK needs; VTK itself is half a gigabyte. A file is some
XML that names the arrays, and behind it their bytes.
"""

from __future__ import annotations

import numpy as np

from demheat.packing.base import Packing
from demheat.packing.io.links import Drawn

TYPES = {"<f8": "Float64", "<i4": "Int32", "<i8": "Int64", "|u1": "UInt8"}


def write(packing: Packing, stream, drawn: Drawn | None) -> None:
    """Write a packing and what is drawn of its network.

    Parameters
    ----------
    packing : Packing
    stream : binary stream
    drawn : Drawn or None
    """
    blocks = _Blocks()
    field = blocks.add("size", packing.size, tuples=3) + blocks.add("periodic", _bytes(packing.periodic), tuples=3)
    point = blocks.add("radius", packing.radii)
    cell, verts, lines = "", np.arange(packing.number)[:, None], np.zeros((0, 2), int)
    if drawn is not None:
        field += blocks.add("links_cut", np.array([drawn.cut]), tuples=1)
        point += blocks.add("temperature", drawn.temperature)
    if drawn is not None and len(drawn.ends):
        # Vertices make bare points visible; beside lines they would need a conductance.
        verts, lines = np.zeros((0, 1), int), drawn.ends
        cell = blocks.add("conductance", drawn.conductance) + blocks.add("heat_flow", drawn.heat_flow)
    parts = [
        f"<FieldData>{field}{_string('domain', packing.domain)}</FieldData>",
        f'<Piece NumberOfPoints="{packing.number}" NumberOfVerts="{len(verts)}" NumberOfLines="{len(lines)}" '
        'NumberOfStrips="0" NumberOfPolys="0">',
        f'<PointData Scalars="radius">{point}</PointData>',
        f"<CellData>{cell}</CellData>",
        f"<Points>{blocks.add('Points', packing.centers)}</Points>",
        f"<Verts>{_cells(blocks, verts)}</Verts>",
        f"<Lines>{_cells(blocks, lines)}</Lines>",
    ]
    _put_down(stream, "\n".join(parts), blocks.arrays)


def _put_down(stream, parts, arrays):
    """Write the XML, and behind it the bytes of the arrays."""
    head = '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
    text = '<?xml version="1.0"?>\n' + head + "\n<PolyData>\n" + parts + "\n</Piece>\n</PolyData>\n"
    stream.write((text + '<AppendedData encoding="raw">\n_').encode())
    for array in arrays:
        stream.write(np.uint64(array.nbytes).astype("<u8").tobytes())
        stream.write(array.tobytes())
    stream.write(b"\n</AppendedData>\n</VTKFile>\n")


class _Blocks:
    """The arrays of a file in order, each behind its length in bytes."""

    def __init__(self):
        self.arrays, self.offset = [], 0

    def add(self, name, array, tuples=None):
        """Put an array in.

        Parameters
        ----------
        name : str
        array : (n,) or (n, k) array, or None
        tuples : int, optional
            Number of tuples, which field data must say; without it the number of components is said.

        Returns
        -------
        str
            XML that names it; nothing for None.
        """
        if array is None:
            return ""
        kind = "<f8" if array.dtype.kind == "f" else "|u1" if array.dtype.itemsize == 1 else "<i8"
        if kind == "<i8" and (array.size == 0 or np.max(array) < 2**31):
            kind = "<i4"
        self.arrays.append(np.ascontiguousarray(array, dtype=kind))
        width = array.shape[1] if array.ndim == 2 else 1
        more = f'NumberOfTuples="{tuples}" ' if tuples else f'NumberOfComponents="{width}" '
        text = f'<DataArray type="{TYPES[kind]}" Name="{name}" {more}format="appended" offset="{self.offset}"/>'
        self.offset += 8 + self.arrays[-1].nbytes
        return text


def _cells(blocks, cells):
    """Cells of equal numbers of points, (m, k) int array."""
    offsets = np.arange(1, len(cells) + 1) * cells.shape[1]
    return blocks.add("connectivity", cells.ravel()) + blocks.add("offsets", offsets)


def _bytes(flags):
    return np.asarray(flags).astype(np.uint8)


def _string(name, value):
    codes = " ".join(str(code) for code in [*value.encode(), 0])
    return f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{codes}</Array>'
