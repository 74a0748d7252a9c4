"""What the rule of layers refuses and what it allows: sources of one line or two."""

import pytest
from test_layers import refused


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.scene", "from demheat.field import Field"),
        ("demheat.gallery", "import references.bounds"),
        ("demheat.conduction.steady", "def f():\n    from demheat.referee import heat_balance"),
        ("demheat.packing.relax", "from demheat.network import base"),
        ("demheat.packing.relax_kernels", "from demheat.packing.base import Packing"),
        ("demheat.packing.relax", "from ..network.base import Network"),
        ("demheat.network.base", "from demheat import solve"),
        ("demheat.dem", "from demheat import referee"),
        ("demheat.dem.solver", "from demheat.network.laguerre import laguerre"),
        ("demheat.laws", "from demheat.network.calibrated import contact_facets"),
        ("references.exact", "from demheat import gallery"),
        ("references.fem", "import demheat"),
        ("references.bounds", "from studies.harness.printed import printed"),
        ("references.exact.forms", "import numba"),
        ("references.fem", "import gmsh"),
        ("references.meshes", "import gmsh"),
        ("references.mesh", "from skfem.element import ElementTetP2"),
        ("demheat.dem", "import pandas as pd"),
        ("references.exact", "from matplotlib import pyplot"),
        ("demheat.network.laguerre", "import multivoro"),
        ("demheat.conduction.steady", "from demheat.sampling import edges"),
        ("references.voxels.kernels", "from references.voxels.paint import parents"),
        ("references.exact.forms", "from references.fem import solve"),
        ("studies.harness.pick", "from studies.common import slab"),
        ("studies.common.slab", "from studies import fig05_slab"),
        ("studies.fig05_slab", "from studies import fig07_sphere"),
    ],
)
def test_a_breach_is_seen(name, source):
    assert len(refused(name, source)) == 1


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("demheat.packing.relax", "from .base import Packing"),
        ("demheat.dem", "from demheat.conduction import steady"),
        ("references.fft.transforms", "import pyfftw"),
        ("references.mesh.shapes", "import gmsh"),
        ("references.voxels.kernels", "from numba import njit"),
        ("studies.fig14_single_inclusion", "import pandas\nfrom references import bounds"),
        ("studies.zeta2.rows", "from studies.zeta2 import pool"),
        ("references.multipole.field_kernels", "from references.multipole.translation_kernels import bases"),
    ],
)
def test_what_is_allowed_is_not_refused(name, source):
    assert refused(name, source) == []
