"""ParaView's PolyData (.vtp): points with radius, links as lines (docs.vtk.org, VTK XML file formats).

Written by hand, see `demheat.io.vtk`.
"""

import numpy as np

from demheat.io.packings.segments import Segments
from demheat.io.vtk import Blocks, put_down
from demheat.packing.base import Packing


def write(packing: Packing, stream, drawn: Segments | None) -> None:
    """Write a packing and what is drawn of its network."""
    blocks = Blocks()
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
        f"<Verts>{blocks.cells(verts)}</Verts>",
        f"<Lines>{blocks.cells(lines)}</Lines>",
    ]
    put_down(stream, "PolyData", "\n".join(parts), blocks.arrays)


def _bytes(flags):
    return np.asarray(flags).astype(np.uint8)


def _string(name, value):
    codes = " ".join(str(code) for code in [*value.encode(), 0])
    return f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{codes}</Array>'
