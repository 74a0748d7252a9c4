"""Names of shapes as others call them, and what they are called here."""

import re
from collections.abc import Sequence
from pathlib import Path

from demheat.io.surfaces import READ
from demheat.io.words import nearest
from demheat.scene import SurfaceMesh

# Formats of surfaces, and of solids that are none.
SURFACES, SOLIDS = (*READ, ".off"), (".step", ".stp", ".iges", ".igs", ".brep")
ALSO = {
    "sphere": ("ball", "bead", "particle", "circle"),
    "box": ("cube", "cuboid", "brick", "block", "rectangle", "prism"),
    "layer": ("slab", "plate", "sheet", "lamella", "film"),
    "cylinder": ("rod", "fiber", "fibre", "tube", "pipe", "wire", "disc", "disk"),
    "ellipsoid": ("spheroid", "ellipse", "grain"),
    "torus": ("ring", "donut", "doughnut"),
    "half-space": ("half space", "halfspace", "plane"),
    "union": ("group", "compound", "assembly"),
    SurfaceMesh.kind: ("mesh", "surface", "triangles", *(name.strip(".") for name in (*SURFACES, *SOLIDS))),
}
PYTHON = ("level set", "levelset", "gyroid", "function", "implicit", "tpms")


def meant(word: str, known: Sequence[str]) -> str:
    """What to say of a name that is no shape's."""
    plain = re.sub(r"[\s_-]+", " ", word).strip().lower()
    if plain in PYTHON:
        return "; level sets are for Python alone, demheat.LevelSet"
    found = next((name for name, others in ALSO.items() if plain in others and name in known), None)
    return f"; did you mean {found!r}?" if found else nearest(word, known)


def no_spheres(path: Path) -> str:
    """What to say of the file of a body where spheres are asked for; empty of other files."""
    suffix = path.suffix.lower()
    if suffix in SOLIDS:
        return f'is a solid of a CAD program; must be exported as triangles (.stl), with shape = "{SurfaceMesh.kind}"'
    return f'is a surface of triangles; must have shape = "{SurfaceMesh.kind}" beside it' if suffix in SURFACES else ""
