"""Meshing in this process, for tests that change what is done there; what they do where Gmsh does not load."""

import pytest

from references.mesh import load_gmsh


def gmsh_or_skip():
    """Skip a test where Gmsh does not load."""
    try:
        load_gmsh()
    except ImportError as error:
        pytest.skip(str(error))


def mesh_here(function, *arguments, **how):
    """In the place of `references.mesh.apart.run_apart`."""
    try:
        return function(*arguments)
    finally:
        load_gmsh().finalize()
