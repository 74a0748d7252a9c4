"""OpenFOAM: finite volumes, the solver laplacianFoam; voxels as hexahedra, or the tetrahedra that all are given.

Its diffusivity DT is a field, one value per cell. What a face conducts is interpolated by a scheme that its user
names: `linear`, the tutorials' own, takes the mean of the two cells, `harmonic` that of two resistances in series. On
tetrahedra the part of the gradient along a face is interpolated, too, from the last round's: `Gauss linear`, the
tutorials' own, or `leastSquares`. Conjugate gradients with its incomplete Cholesky factor to 1e-12, in rounds until a
residual begins below 1e-9. The heat is DT grad T integrated over the wall by its function object `surfaceFieldValue`.
No case of its documentation is run. https://www.openfoam.com
"""

import os
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np

from studies.peers import given, meshes
from studies.peers.alone import packaged, ran_alone
from studies.peers.outside import Found, ran

TITLE = "OpenFOAM"
KIND = "image"
GET = "apt: openfoam"
CANNOT = {"pores in an image": "a diffusivity of 0 divides by zero; cells of pores would have to be cut out"}
EXPLAINED = (
    "scheme linear: a face between phases conducts (k1 + k2) / 2, not 2 k1 k2 / (k1 + k2), so that no laminate across "
    "the heat is exact. Tetrahedra: Gauss linear takes the middle of a face to lie between the centres of its cells "
    "and is 7 % off where all conducts alike, however fine; leastSquares is exact there, not where the gradient jumps"
)
SCHEMES, GRADIENTS = ("harmonic", "linear"), ("leastSquares", "Gauss linear")
# Bodies whose rows compare the schemes, and those on tetrahedra.
COMPARED = ("layers across", "layers along", "layers off the grid", "sphere 10", "sphere 0.01")
ON_MESHES = ("homogeneous", "layers across", "layers along", "sphere 10", "sphere 0.01")
CASES = (
    *({"scene": name, "n": n} for name in meshes.BODIES for n in (16, 32, 64)),
    *({"scene": name, "n": 32, "scheme": "linear"} for name in COMPARED),
    *({"scene": name, "given": "mesh", "size": size} for name in ON_MESHES for size in meshes.SIZES),
    *(
        {"scene": name, "given": "mesh", "size": h, "gradient": "Gauss linear"}
        for name in ON_MESHES
        for h in (0.08, 0.05)
    ),
)
# Where Debian keeps what its programs look for.
HOME = {"WM_PROJECT_DIR": os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam")}
ROUNDS = 500

HEAD = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"
CONTROL = """application laplacianFoam; startFrom latestTime; startTime 0; stopAt endTime; endTime {rounds}; deltaT 1;
writeControl timeStep; writeInterval {rounds}; writeFormat ascii; writePrecision 15; timeFormat general;
"""
SCHEMES_FILE = """ddtSchemes {{ default steadyState; }} divSchemes {{ default none; }}
gradSchemes {{ default {gradient}; }}
laplacianSchemes {{ default Gauss {scheme} corrected; }}
interpolationSchemes {{ default linear; }} snGradSchemes {{ default corrected; }}
"""
SOLUTION = """solvers {{ T {{ solver PCG; preconditioner DIC; tolerance 1e-12; relTol {relative}; maxIter 100000; }} }}
SIMPLE {{ nNonOrthogonalCorrectors 0; residualControl {{ T 1e-9; }} }}
"""
BLOCKS = """scale 1;
vertices ((0 0 0) ({x} 0 0) ({x} {y} 0) (0 {y} 0) (0 0 {z}) ({x} 0 {z}) ({x} {y} {z}) (0 {y} {z}));
blocks (hex (0 1 2 3 4 5 6 7) ({n} {n} {n}) simpleGrading (1 1 1));
edges ();
boundary (
  xmin {{ type patch; faces ((0 4 7 3)); }} xmax {{ type patch; faces ((1 2 6 5)); }}
  sides {{ type patch; faces ((0 1 5 4) (3 7 6 2) (0 3 2 1) (4 5 6 7)); }} );
"""
# The last pattern that fits a patch counts, and names count before patterns.
TEMPERATURE = """dimensions [0 0 0 1 0 0 0]; internalField uniform {low};
boundaryField {{
  ".*" {{ type zeroGradient; }}
  xmin {{ type fixedValue; value uniform {high}; }} xmax {{ type fixedValue; value uniform {low}; }} }}
"""
DIFFUSIVITY = """dimensions [0 2 -1 0 0 0 0]; internalField nonuniform List<scalar> {count}
(
{values}
);
boundaryField {{ ".*" {{ type zeroGradient; }} }}
"""
TRANSPORT = "DT DT [0 2 -1 0 0 0 0] 1;\n"
HEATS = """functions {{
  slope {{ type grad; libs ("libfieldFunctionObjects.so"); field T; }}
  hot {{ type surfaceFieldValue; libs ("libfieldFunctionObjects.so"); regionType patch; name xmin;
    operation weightedAreaIntegrate; weightField DT; fields (grad(T)); writeFields false; writePrecision 15; }}
  cold {{ $hot; name xmax; }} }}
"""


def missing():
    """Why it cannot run here, or None."""
    return None if shutil.which("laplacianFoam") else "laplacianFoam is not installed; Debian has it as openfoam"


def version():
    """Debian's."""
    return packaged("openfoam")


def solve(scene, *, n=None, size=None, scheme="harmonic", gradient="leastSquares"):
    """Solve an image of a body, or a body."""
    if (n is None) == (size is None):
        raise ValueError(f"n = {n}, size = {size}: must be one of them, of voxels or of tetrahedra")
    for name, value, known in (("scheme", scheme, SCHEMES), ("gradient", gradient, GRADIENTS)):
        if value not in known:
            raise ValueError(f"{name} = {value!r}: must be one of {known}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write(folder, scene, scheme=scheme, gradient=gradient, relative=0 if size is None else 1e-3)
        cells = _hexahedra(folder, scene, n) if size is None else _tetrahedra(folder, scene, size)
        printed, cost = ran_alone(["laplacianFoam"], folder=folder, environment=HOME)
        heats = _heats(folder)
    rounds = len(re.findall(r"Solving for T", printed))
    if "solution converged" not in printed:
        raise RuntimeError(f"laplacianFoam: residual not met in {rounds} rounds")
    found = meshes.by_heat(scene, heats["hot"])
    steps = sum(map(int, re.findall(r"No Iterations (\d+)", printed)))
    note = f"{rounds} rounds; out at the wall x+ {100 * (heats['cold'] / heats['hot'] - 1):+.1g} %"
    return Found(found, cost, unknowns=cells, iterations=steps, note=note)


def _write(folder, scene, *, relative, **schemes):
    """All but the mesh and what is on it."""
    high, low = scene.walls["x-"], scene.walls["x+"]
    _file(folder / "system" / "controlDict", CONTROL, rounds=ROUNDS)
    _file(folder / "system" / "fvSchemes", SCHEMES_FILE, **schemes)
    _file(folder / "system" / "fvSolution", SOLUTION, relative=relative)
    _file(folder / "system" / "heats", HEATS)
    _file(folder / "constant" / "transportProperties", TRANSPORT)
    _file(folder / "0" / "T", TEMPERATURE, kind="volScalarField", high=high, low=low)


def _file(path, text, *, kind="dictionary", **values):
    path.parent.mkdir(exist_ok=True)
    path.write_text((HEAD + text).format(kind=kind, name=path.name, **values))


def _diffusivity(folder, k):
    values = "\n".join(map(repr, k.tolist()))
    _file(folder / "0" / "DT", DIFFUSIVITY, kind="volScalarField", count=len(k), values=values)


def _hexahedra(folder, scene, n):
    """A voxel each; how many."""
    image = given.image(scene, n)
    k = np.array([material.conductivity for material in image.phases])[image.phase]
    if not k.all():
        raise NotImplementedError(f"laplacianFoam: {CANNOT['pores in an image']}")
    x, y, z = scene.size
    _file(folder / "system" / "blockMeshDict", BLOCKS, x=x, y=y, z=z, n=n)
    # x runs fastest.
    _diffusivity(folder, k.ravel(order="F"))
    ran(["blockMesh"], folder=folder, environment=HOME)
    return k.size


def _tetrahedra(folder, scene, size):
    """The mesh that all are given, in the order of its file; how many."""
    mesh = meshes.conforming(scene, size=size)
    meshes.write_msh(folder / "body.msh", mesh)
    _diffusivity(folder, scene.conductivities[mesh.phase].astype(float))
    ran(["gmshToFoam", "body.msh"], folder=folder, environment=HOME)
    return len(mesh.cells)


def _heats(folder):
    """Heat that enters at the wall x- and leaves at x+, W."""
    command = ["postProcess", "-latestTime", "-fields", "(T DT)", "-dict", "system/heats"]
    ran(command, folder=folder, environment=HOME)
    heats = {}
    for name in ("hot", "cold"):
        (path,) = (folder / "postProcessing" / name).rglob("*.dat")
        heats[name] = -float(re.search(r"\((\S+)", path.read_text().splitlines()[-1])[1])
    return heats
