"""Meshing in this process, for tests that change what is done there."""

from references.mesh import load_gmsh


def mesh_here(function, *arguments, **how):
    """In the place of `references.mesh.apart.run_apart`."""
    try:
        return function(*arguments)
    finally:
        load_gmsh().finalize()
