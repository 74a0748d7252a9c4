"""VTK's XML files (docs.vtk.org, VTK XML file formats): some XML that names arrays, and behind it their bytes.

Written by hand: meshio has neither PolyData nor ImageData; pyevtk, looked at in version 1.7.0, writes vectors one
number at a time in Python and leaves the number of tuples out of field data, which VTK needs; VTK itself is half a
gigabyte.
"""

import numpy as np

TYPES = {"<f8": "Float64", "<i4": "Int32", "<i8": "Int64", "|u1": "UInt8"}


class Blocks:
    """The arrays of a file in order, each behind its length in bytes."""

    def __init__(self):
        self.arrays, self.offset = [], 0

    def add(self, name, array, tuples=None):
        """Put an array in."""
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

    def add_all(self, arrays):
        """Put arrays in by their names; XML that names them."""
        return "".join(self.add(name, array) for name, array in arrays.items())

    def cells(self, cells):
        """Cells of equal numbers of points, (m, k) int array."""
        offsets = np.arange(1, len(cells) + 1) * cells.shape[1]
        return self.add("connectivity", cells.ravel()) + self.add("offsets", offsets)


def put_down(stream, kind: str, parts: str, arrays, *, more: str = "") -> None:
    """Write the XML, and behind it the bytes of the arrays."""
    head = f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">'
    text = f'<?xml version="1.0"?>\n{head}\n<{kind}{more}>\n{parts}\n</Piece>\n</{kind}>\n'
    stream.write((text + '<AppendedData encoding="raw">\n_').encode())
    for array in arrays:
        stream.write(np.uint64(array.nbytes).astype("<u8").tobytes())
        stream.write(array.tobytes())
    stream.write(b"\n</AppendedData>\n</VTKFile>\n")
