"""GetDP: finite elements by formulations that its users write; linear or quadratic tetrahedra on the mesh that all get.

The heat through a wall is the dual of the wall's temperature, a global quantity of its own, which is the reaction of
the equations; solved by its default, MUMPS through PETSc, a direct solver. No case of its documentation is
run. https://getdp.info
"""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from studies.peers import meshes
from studies.peers.alone import ran_alone
from studies.peers.outside import Found

TITLE = "GetDP"
KIND = "mesh"
GET = "apt: getdp"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()

SCRIPT = """
Group {{ Hot = Region[{hot}]; Cold = Region[{cold}]; Walls = Region[{{{hot}, {cold}}}]; Body = Region[{{{phases}}}]; }}
Function {{ {conductivities} }}
Constraint {{ {{ Name Walls; Case {{
  {{ Region Hot; Value {high:.17g}; }} {{ Region Cold; Value {low:.17g}; }} }} }} }}
FunctionSpace {{ {{ Name H; Type Form0;
  BasisFunction {{
    {{ Name s; NameOfCoef t; Function BF_Node; Support Body; Entity NodesOf[All, Not Walls]; }}
    {{ Name w; NameOfCoef tw; Function BF_GroupOfNodes; Support Body; Entity GroupsOfNodesOf[Walls]; }} }}
  GlobalQuantity {{
    {{ Name WallT; Type AliasOf; NameOfCoef tw; }} {{ Name Heat; Type AssociatedWith; NameOfCoef tw; }} }}
  Constraint {{ {{ NameOfCoef WallT; EntityType GroupsOfNodesOf; NameOfConstraint Walls; }} }} }} }}
Jacobian {{ {{ Name V; Case {{ {{ Region All; Jacobian Vol; }} }} }} }}
Integration {{ {{ Name I; Case {{ {{ Type Gauss; Case {{
  {{ GeoElement Tetrahedron; NumberOfPoints 4; }} {{ GeoElement Tetrahedron2; NumberOfPoints 4; }} }} }} }} }} }}
Formulation {{ {{ Name Conduction; Type FemEquation;
  Quantity {{
    {{ Name T; Type Local; NameOfSpace H; }}
    {{ Name WallT; Type Global; NameOfSpace H[WallT]; }} {{ Name Heat; Type Global; NameOfSpace H[Heat]; }} }}
  Equation {{
    Galerkin {{ [k[] * Dof{{d T}}, {{d T}}]; In Body; Jacobian V; Integration I; }}
    GlobalTerm {{ [-Dof{{Heat}}, {{WallT}}]; In Walls; }} }} }} }}
Resolution {{ {{ Name Solve; System {{ {{ Name A; NameOfFormulation Conduction; }} }}
  Operation {{ Generate[A]; Solve[A]; SaveSolution[A]; }} }} }}
PostProcessing {{ {{ Name Found; NameOfFormulation Conduction; Quantity {{
  {{ Name energy; Value {{ Integral {{ [k[] * {{d T}} * {{d T}}]; In Body; Jacobian V; Integration I; }} }} }}
  {{ Name heat; Value {{ Term {{ [{{Heat}}]; In Walls; }} }} }} }} }} }}
PostOperation {{ {{ Name Found; NameOfPostProcessing Found; Operation {{
  Print[energy[Body], OnGlobal, Format Table, File "energy.txt"];
  Print[heat, OnRegion Hot, Format Table, File "heat.txt"]; }} }} }}
"""


def missing():
    """Why it cannot run here, or None."""
    return None if shutil.which("getdp") else "getdp is not installed; Debian has it as getdp"


def version():
    """As it says."""
    return subprocess.run(["getdp", "-version"], capture_output=True, text=True).stderr.strip()


def solve(scene, *, size, order=1):
    """Solve a body."""
    mesh = meshes.conforming(scene, size=size, order=order)
    command = ["getdp", "body.pro", "-msh", "body.msh", "-solve", "Solve", "-pos", "Found", "-v", "4"]
    with tempfile.TemporaryDirectory() as folder:
        meshes.write_msh(Path(folder) / "body.msh", mesh)
        (Path(folder) / "body.pro").write_text(script(scene, mesh))
        printed, cost = ran_alone(command, folder=folder)
        heat, energy = (float((Path(folder) / f"{name}.txt").read_text().split()[-1]) for name in ("heat", "energy"))
    found = meshes.by_heat(scene, heat)
    # Two of them are the walls' heat.
    unknowns = int(re.search(r"(\d+) Dofs", printed)[1]) - 2
    apart = 100 * (meshes.by_energy(scene, energy) / found - 1)
    return Found(found, cost, unknowns=unknowns, note=f"by its energy {apart:+.1g} % of this")


def script(scene, mesh) -> str:
    """What it is told."""
    values = meshes.phases(mesh, scene)
    return SCRIPT.format(
        phases=", ".join(map(str, values)),
        conductivities=" ".join(f"k[Region[{phase}]] = {k:.17g};" for phase, k in values.items()),
        **meshes.walls(scene),
    )
