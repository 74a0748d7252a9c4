"""Closed surfaces of triangles out of files: STL, PLY, OBJ, msh and what else meshio reads."""

import contextlib
import io
import warnings
from collections.abc import Sequence

import numpy as np

from demheat.io.words import nearest_file
from demheat.runtime.extras import extra
from demheat.runtime.paths import checked_path, replaced
from demheat.scene import Material, SurfaceMesh
from demheat.scene.inputs import chosen, vector

# Formats that are read and tested; meshio knows more.
READ = (".stl", ".ply", ".obj", ".msh")
# Of lengths in files, m.
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "nm": 1e-9, "in": 0.0254}


def read_surface(
    path, material: Material, *, unit: str = "m", offset: Sequence[float] = (0.0, 0.0, 0.0), resistance: float = 0.0
) -> SurfaceMesh:
    """Read a body from the file of its surface.

    Parameters
    ----------
    path : path
        STL, PLY, OBJ, msh, or another format that meshio knows by its suffix; quadrangles are halved.
    material : Material
    unit : {"m", "mm", "cm", "um", "nm", "in"}
        Of its coordinates: most formats do not tell.
    offset : (3,) sequence of float, m
        By which it is moved then.
    resistance : float, m2 K/W
        Of its surface.

    Raises
    ------
    ValueError
        If the file is none, holds no triangles, or their surface is not closed or crosses itself.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from demheat import Material
    >>> from demheat.io.surfaces import read_surface
    >>> text = "v 0 0 0 | v 1 0 0 | v 0 1 0 | v 0 0 1 | f 1 3 2 | f 1 2 4 | f 1 4 3 | f 2 3 4"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "corner.obj")
    ...     _ = path.write_text(text.replace(" | ", chr(10)))
    ...     print(f"{read_surface(path, Material(5.0), unit='mm').volume:.3e}")
    1.667e-10
    """
    path = checked_path(path)
    chosen("unit", unit, UNITS)
    offset = np.array(vector("offset", offset))
    points, triangles = _read(path)
    try:
        return SurfaceMesh(points * UNITS[unit] + offset, triangles, material, resistance=resistance)
    except ValueError as error:
        told = str(error)
        raise ValueError(f"{path}{told.removeprefix('SurfaceMesh')}" if ": " in told else told) from None


def write_surface(body: SurfaceMesh, path) -> None:
    """Write the surface of a body as OBJ, in metres, to the last bit."""
    with replaced(checked_path(path)) as part, part.open("w", encoding="utf-8", newline="\n") as stream:
        stream.writelines("v {!r} {!r} {!r}\n".format(*corner) for corner in body.vertices.tolist())
        stream.writelines("f {} {} {}\n".format(*corners) for corners in (body.triangles + 1).tolist())


def _read(path):
    """Points and triangles of a file."""
    with extra("a surface in a file"):
        import meshio

    if not path.is_file():
        raise ValueError(f"{path}: there is no such file{nearest_file(path)}")
    try:
        # It prints what it makes of a file, and takes the text of an STL for a number, which overflows.
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                mesh = meshio.read(path)
    except (Exception, SystemExit) as error:  # noqa: BLE001, meshio's readers raise whatever they stumble over
        told = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path}: no surface that can be read: {told}") from None
    triangles = [np.zeros((0, 3), int)]
    for block in mesh.cells:
        if block.type == "triangle":
            triangles.append(block.data)
        elif block.type == "quad":
            triangles += [block.data[:, [0, 1, 2]], block.data[:, [0, 2, 3]]]
    triangles = np.concatenate(triangles).astype(int)
    points = np.asarray(mesh.points, dtype=float)
    if not len(triangles) or points.shape[1] != 3:
        kinds = ", ".join(sorted({block.type for block in mesh.cells})) or "none"
        raise ValueError(
            f"{path}: holds no triangles in space, cells of type {kinds}; must be a closed surface of them"
        )
    return points, triangles
