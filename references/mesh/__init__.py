"""Tetrahedral meshes of a scene: `make` one, `write` one. The only home of gmsh and meshio."""

from references.mesh.cad import make
from references.mesh.cells import EDGE_COLUMN, Faces, Mesh, Wall, twins
from references.mesh.export import write
from references.mesh.gmsh_session import PACKAGES, load_gmsh
from references.mesh.round import make_round
from references.mesh.sides import split

__all__ = [
    "EDGE_COLUMN",
    "PACKAGES",
    "Faces",
    "Mesh",
    "Wall",
    "load_gmsh",
    "make",
    "make_round",
    "split",
    "twins",
    "write",
]
