"""Finite elements of others that are libraries in Python: what their scripts are given, and what they answer."""

import subprocess
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from studies.peers import meshes
from studies.peers.alone import THREADS
from studies.peers.outside import Found, asked, python_of

SCRIPTS = Path(__file__).parent / "programs" / "scripts"


def library(name, *needed, version):
    """`missing`, `version` and `solve` of a library: packages that must be there, and the expression of its version."""
    return partial(absent, name, *needed), partial(told_version, name, version), partial(solved, name)


def solved(name, scene, *, size, order=1) -> Found:
    """Solve a body by the script NAME_body.py in the Python that has the library."""
    mesh = meshes.corners(meshes.conforming(scene, size=size, order=order))
    given = {
        "order": order,
        "phases": meshes.phases(mesh, scene),
        "length": scene.size[0],
        "high": scene.walls["x-"],
        "low": scene.walls["x+"],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "body"
        np.savez(f"{path}.npz", points=mesh.points, cells=mesh.cells, groups=meshes.FIRST + mesh.phase)
        meshes.write_msh(f"{path}.msh", mesh)
        script = SCRIPTS / f"{name}_body.py"
        told = asked(python_of(name), script, given | {"mesh": str(path)}, folder=folder, environment=THREADS)
    found = meshes.by_energy(scene, told["energy"])
    apart = 100 * (meshes.by_heat(scene, told["heat"]) / found - 1)
    note = f"by its flux integrated over the wall x- {apart:+.2g} % of this"
    return Found(found, told["cost"], unknowns=told["unknowns"], note=note)


def absent(name, *packages) -> str | None:
    """Why a library cannot be run here, or None."""
    for package in packages:
        if python_of(name, package) is None:
            return f"no Python here has {package}"
    return None


def told_version(name, expression) -> str:
    """What a library says its version is."""
    code = f"import {expression.partition('.')[0]}; print({expression})"
    asked = subprocess.run([python_of(name), "-c", code], capture_output=True, text=True)
    return asked.stdout.strip()
