"""Tetrahedral meshes of a scene: `make` one, `write` one. The only home of gmsh and meshio."""

from references.mesh.cad import PACKAGES, load_gmsh, make
from references.mesh.cells import EDGE_COLUMN, Mesh, Wall, twins
from references.mesh.export import write

__all__ = ["EDGE_COLUMN", "PACKAGES", "Mesh", "Wall", "load_gmsh", "make", "twins", "write"]
