"""What `import demheat` loads, and the modules that declare methods: numpy, and nothing that takes long."""

import subprocess
import sys

from imported import DECLARING, ROOT

HEAVY = ("numba", "gmsh", "meshio", "skfem", "pyfftw", "pyamg", "pandas", "matplotlib", "scipy", "tifffile", "nrrd")
HEAVY += ("dask", "distributed", "cloudpickle", "zarr", "xarray", "pyvista")


STATEMENTS = (
    "import demheat",
    "from demheat import gallery, referee",
    "from demheat import Calibrated, Laguerre, Platonic",
    "import benchmark; benchmark.load('nafems-t3')",
    *(f"import {name}" for name in DECLARING),
)
# Each in turn, in one process: what is heavy stands beside the first that loads it.
CODE = f"""
import sys
for statement in {STATEMENTS}:
    before = set(sys.modules)
    exec(statement)
    for name in set({HEAVY}) & set(sys.modules) - before:
        print(f"{{statement}} loads {{name}}")
"""


def test_the_package_loads_numpy_only():
    done = subprocess.run([sys.executable, "-c", CODE], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == ""


def test_declaring_modules_are_found():
    assert {"demheat.dem", "references.fem", "references.fft", "references.bounds"} <= set(DECLARING)
