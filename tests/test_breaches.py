"""What the rule of layers refuses and what it allows: sources of one line or two."""

import pytest
from imported import imports
from test_layers import refused


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.scene", "from demheat.field import Field"),
        ("demheat.gallery", "import references.bounds"),
        ("demheat.conduction.steady", "def f():\n    from demheat.referee import heat_balance"),
        ("demheat.packing.relax_kernels", "from demheat.packing.base import Packing"),
        ("demheat.packing.relax", "from ..network.base import Network"),
        ("demheat.dem", "from demheat import referee"),
        ("references.fem", "import demheat"),
        ("references.exact.forms", "import numba"),
        ("references.meshes", "import gmsh"),
        ("demheat.dem", "import pandas as pd"),
        ("references.exact.forms", "from references.fem import solve"),
        ("studies.fig05_slab", "from studies import fig07_sphere"),
    ],
)
def test_a_breach_is_seen(name, source):
    assert len(refused(name, imports(name, source))) == 1


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.packing.relax", "from .base import Packing"),
        ("demheat.dem", "from demheat.conduction import steady"),
        ("references.mesh.shapes", "import gmsh"),
        ("references.voxels.kernels", "from numba import njit"),
        ("studies.zeta2.rows", "from studies.zeta2 import pool"),
        ("references.multipole.field_kernels", "from references.multipole.translation_kernels import bases"),
    ],
)
def test_what_is_allowed_is_not_refused(name, source):
    assert refused(name, imports(name, source)) == []
