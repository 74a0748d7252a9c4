"""CalculiX: finite elements for engineers, by Abaqus's keywords; elements DC3D4 and DC3D10 on the mesh that all get.

The heat is the total of RFL, its reactions, at the nodes of a wall, which it prints with seven digits; solved by the
default, SPOOLES, a direct solver, twice: it takes a second round to see that the equations are linear. Its own case is
one of its suite of tests, a beam between 100 and 20 degrees, with the heat in the suite's file of results.
https://www.calculix.de
"""

import gzip
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from studies.peers import meshes
from studies.peers.alone import ran_alone
from studies.peers.outside import Found

TITLE = "CalculiX"
KIND = "mesh"
GET = "apt: calculix-ccx"
CANNOT = {}
EXPLAINED = "none: the equations are those of our finite elements on the same mesh"
CASES = meshes.cases()

# Where Debian's calculix-ccx-test keeps the suite of version 2.11.
SUITE = Path("/usr/share/doc/calculix-ccx-test/examples/test")

PHASE = """*MATERIAL, NAME=OF{phase}
*CONDUCTIVITY
{k:.17g}
*SOLID SECTION, ELSET=PHASE{phase}, MATERIAL=OF{phase}
"""
STEP = """*STEP
*HEAT TRANSFER, STEADY STATE
*BOUNDARY
{hot}, 11, 11, {high:.17g}
{cold}, 11, 11, {low:.17g}
*NODE PRINT, NSET={hot}, TOTALS=ONLY
RFL
*END STEP
"""


def missing():
    """Why it cannot run here, or None."""
    return None if shutil.which("ccx") else "ccx is not installed; Debian has it as calculix-ccx"


def version():
    """As it says."""
    asked = subprocess.run(["ccx", "-v"], capture_output=True, text=True)
    return asked.stdout.split()[-1]


def solve(scene, *, size, order=1):
    """Solve a body."""
    mesh = meshes.conforming(scene, size=size, order=order)
    with tempfile.TemporaryDirectory() as folder:
        meshes.write_inp(Path(folder) / "mesh.inp", mesh)
        (Path(folder) / "body.inp").write_text(script(scene, mesh))
        printed, cost = ran_alone(["ccx", "-i", "body"], folder=folder)
        result = (Path(folder) / "body.dat").read_text()
    rounds = len(re.findall(r"^ iteration \d+", printed, re.M))
    found = meshes.by_heat(scene, float(result.split()[-1]))
    return Found(found, cost, unknowns=meshes.unknowns(mesh), note=f"{rounds} direct solves")


def script(scene, mesh) -> str:
    """What it is told."""
    step = STEP.format(
        hot=meshes.FACES["x-"][1].upper(),
        cold=meshes.FACES["x+"][1].upper(),
        high=scene.walls["x-"],
        low=scene.walls["x+"],
    )
    values = meshes.phases(mesh, scene)
    return "*INCLUDE, INPUT=mesh.inp\n" + "".join(PHASE.format(phase=p, k=k) for p, k in values.items()) + step


def own():
    """Heat through the beam of `beamhtbo`, found and in the suite's results, and where that stands."""
    if not SUITE.exists():
        raise NotImplementedError("its suite of tests is not installed; Debian has it as calculix-ccx-test")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "beam.inp").write_bytes(gzip.decompress((SUITE / "beamhtbo.inp.gz").read_bytes()))
        ran_alone(["ccx", "-i", "beam"], folder=folder)
        found = entering((Path(folder) / "beam.dat").read_text())
    documented = entering(gzip.decompress((SUITE / "beamhtbo.dat.ref.gz").read_bytes()).decode())
    return found, documented, "beamhtbo.dat.ref of CalculiX's suite of tests, 2.11"


def entering(results) -> float:
    """Sum of the positive reactions of the nodes in a file of results."""
    table = results.partition("heat generation for set")[2].partition(" for set")[0]
    rows = [line.split() for line in table.splitlines()[1:]]
    return sum(max(float(row[1]), 0.0) for row in rows if len(row) == 2 and row[0].isdigit())
