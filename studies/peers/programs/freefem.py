"""FreeFEM: finite elements by a language of its own; linear or quadratic tetrahedra on the mesh that all are given.

The weak form as its users write it, solved by its default, UMFPACK, a direct solver. The heat is that of the energy,
the integral of k grad T . grad T; the flux integrated over a wall, which its users take as often, is in the remark: it
is another at each wall. No case of its documentation is run. https://freefem.org
"""

import re
import shutil
import tempfile
from pathlib import Path

from studies.peers import meshes
from studies.peers.alone import packaged, ran_alone
from studies.peers.outside import Found

TITLE = "FreeFEM"
KIND = "mesh"
GET = "apt: freefem++"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()

SCRIPT = """
mesh3 Th = readmesh3("body.mesh");
fespace Ph(Th, P0);
fespace Vh(Th, P{order});
real[int] conductivity({count});
{conductivities}
Ph k = conductivity[region];
Vh T, v;
macro grad(u) [dx(u), dy(u), dz(u)] //
solve conduction(T, v) = int3d(Th)(k * (grad(T)' * grad(v))) + on({hot}, T={high:.17g}) + on({cold}, T={low:.17g});
cout.precision(17);
cout << "energy " << int3d(Th)(k * (grad(T)' * grad(T))) << endl;
cout << "hot " << int2d(Th, {hot})(-k * dx(T)) << endl;
cout << "cold " << int2d(Th, {cold})(-k * dx(T)) << endl;
"""


def missing():
    """Why it cannot run here, or None."""
    return None if shutil.which("FreeFem++") else "FreeFem++ is not installed; Debian has it as freefem++"


def version():
    """Debian's: what it prints itself, 4.9, is another's."""
    return packaged("freefem++")


def solve(scene, *, size, order=1):
    """Solve a body."""
    mesh = meshes.conforming(scene, size=size, order=order)
    with tempfile.TemporaryDirectory() as folder:
        meshes.write_medit(Path(folder) / "body.mesh", meshes.corners(mesh))
        (Path(folder) / "body.edp").write_text(script(scene, mesh, order))
        printed, cost = ran_alone(["FreeFem++", "-v", "0", "-nw", "-ne", "-f", "body.edp"], folder=folder)
    found = meshes.by_energy(scene, said(printed, "energy"))
    fluxes = [100 * (meshes.by_heat(scene, said(printed, wall)) / found - 1) for wall in ("hot", "cold")]
    note = f"by its flux integrated over the wall x- {fluxes[0]:+.2g} %, x+ {fluxes[1]:+.2g} % of this"
    return Found(found, cost, unknowns=meshes.unknowns(mesh), note=note)


def script(scene, mesh, order) -> str:
    """What it is told."""
    values = meshes.phases(mesh, scene)
    return SCRIPT.format(
        order=order,
        count=max(values) + 1,
        conductivities="\n".join(f"conductivity[{phase}] = {k:.17g};" for phase, k in values.items()),
        **meshes.walls(scene),
    )


def said(printed, word) -> float:
    """The number after a word at the start of a line."""
    return float(re.search(rf"^{word} (\S+)", printed, re.M)[1])
