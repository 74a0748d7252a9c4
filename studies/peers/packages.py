"""Programs that are packages of some Python: why one cannot run here, its version, and how its scripts are asked."""

import subprocess
import tempfile
from functools import cache, partial
from pathlib import Path

import numpy as np

from studies.peers.given import image
from studies.peers.outside import Found, asked, python_of

SCRIPTS = Path(__file__).parent / "programs" / "scripts"


def asked_of(name: str, get: str, *, module: str | None = None):
    """A program's `missing` and `version`, where it is a package: of that name, unless a module of another has it."""
    return partial(missing, name, get, module), partial(version, name, module or name, module)


def missing(name: str, get: str, module: str | None = None) -> str | None:
    """Reason why a package cannot run here, in one line; None if it can."""
    return None if python_of(name, module) else f"no Python here has {module or name} ({get})"


@cache
def version(name: str, distribution: str, module: str | None = None) -> str:
    """Version of an installed distribution."""
    code = f"from importlib.metadata import version; print(version({distribution!r}))"
    return subprocess.run([python_of(name, module), "-c", code], capture_output=True, text=True, check=True).stdout[:-1]


def own_of(name: str, documented: float, source: str):
    """A program's `own`: what its script `own_NAME.py` finds, what its documentation has, and where that stands."""

    def own():
        found = asked(python_of(name), SCRIPTS / f"own_{name}.py", {})["value"]
        return found, documented, source

    return own


def found(name: str, given: dict, *, module: str | None = None, note="", **knobs) -> Found:
    """What the script `with_NAME.py` answers to what it is given."""
    answer = asked(python_of(name, module), SCRIPTS / f"with_{name}.py", given, **knobs)
    return Found(
        answer["conductivity"], answer["cost"], answer["unknowns"], answer["iterations"], note.format_map(answer)
    )


def found_on_image(name: str, scene, n: int, **more) -> Found:
    """What the script `with_NAME.py` answers to the image of a body."""
    drawn = image(scene, n)
    values = [drawn.materials[label].conductivity for label in range(len(drawn.materials))]
    given = {"conductivities": values, "walls": dict(scene.wall_temperatures), **more}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.npz"
        np.savez(path, labels=drawn.labels, spacing=drawn.voxel[0])
        return found(name, given | {"image": str(path)})
