"""What `import demheat` loads, and the modules that declare methods: numpy, and nothing that takes long."""

import subprocess
import sys

import pytest
from imported import DECLARING, ROOT

HEAVY = ("numba", "gmsh", "meshio", "skfem", "pyfftw", "pyamg", "pandas", "matplotlib", "scipy", "tifffile", "nrrd")
HEAVY += ("dask", "distributed", "cloudpickle", "zarr", "xarray", "pyvista")


@pytest.mark.parametrize(
    "statement",
    [
        "import demheat",
        "from demheat import gallery, referee",
        "from demheat import Calibrated, Laguerre, Platonic",
        "import benchmark; benchmark.load('nafems-t3')",
        *(f"import {name}" for name in DECLARING),
    ],
)
def test_the_package_loads_numpy_only(statement):
    code = f"import sys; {statement}; print([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_declaring_modules_are_found():
    assert {"demheat.dem", "references.fem", "references.fft", "references.bounds"} <= set(DECLARING)
