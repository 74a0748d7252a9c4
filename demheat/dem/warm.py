"""The first solve on a machine: a second process compiles what it will need while the first one packs.

Numba compiles one kernel at a time in a process; a second process fills the folder of kernels beside it. What that one
has not begun when the packing is done, the first one compiles itself, and waits for the rest. Nothing depends on the
second process: if it cannot be started or ends early, all is compiled as it is met. It ends with the first one.

None is started where kernels are kept already, for one thread, or with DEMHEAT_WARM=0 in the environment.
"""

import contextlib
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numba
import numpy as np

from demheat.conduction.multigrid import preconditioner
from demheat.conduction.products import advance, apply, dot
from demheat.conduction.steady import AMG_UNKNOWNS, TOLERANCE, solve_checked
from demheat.network import laguerre_kernels
from demheat.network.base import FEW, Facets
from demheat.network.interface import connect
from demheat.network.laguerre import laguerre
from demheat.network.links_kernels import links_of
from demheat.packing.base import Packing
from demheat.runtime.compiled import ROOT, is_kept
from demheat.runtime.progress import stage
from demheat.sampling.field_of import field_of
from demheat.scene import Material, Scene

# Lattice planes of what is solved for the sake of its kernels: enough for those of many rows, and a multigrid with two
# levels.
SIDE = 17
# Seconds that the second process is waited for at most.
PATIENCE = 300.0
# Seconds between looks whether it is done.
POLL = 0.05


class Helper:
    """A second process that compiles, if one is of use."""

    def __init__(self, parts):
        self.process, self.folder, self.parts = None, None, tuple(parts)
        if not (self.parts and _useful()):
            return
        with contextlib.suppress(OSError):
            self.folder = tempfile.mkdtemp(prefix="demheat-warm-")
            path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
            self.process = subprocess.Popen(
                [sys.executable, "-m", "demheat.dem.warm", self.folder, *(part.__name__ for part in self.parts)],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": path},
            )

    def __enter__(self):
        return self

    def join(self, *parts):
        """Compile what nobody has begun, then wait for what the other process has."""
        if self.process is None:
            return
        with stage("compiling, once"):
            work_off(self.folder, self.parts[::-1])
            end = time.monotonic() + PATIENCE
            while not all(_done_file(self.folder, part).exists() for part in parts or self.parts):
                if self.process.poll() is not None or time.monotonic() > end:
                    break
                time.sleep(POLL)

    def __exit__(self, *_):
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process.stdin.close()
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)


def _useful():
    """Whether a second process would help: kernels are to be compiled and kept, and there is a second core."""
    return (
        os.environ.get("DEMHEAT_WARM") != "0"
        and not numba.config.DISABLE_JIT
        and numba.get_num_threads() > 1
        # Programs that only contain Python would start themselves.
        and Path(sys.executable or "").name.startswith("python")
        and not is_kept(Path(laguerre_kernels.__file__))
    )


def work_off(folder, parts):
    """Do the parts that nobody has begun; what fails is left to who needs it."""
    for part in parts:
        try:
            (Path(folder) / part.__name__).touch(exist_ok=False)
        except OSError:
            continue
        with contextlib.suppress(Exception):
            part()
        _done_file(folder, part).touch()


def _done_file(folder, part):
    return Path(folder) / f"{part.__name__}.done"


def cells():
    """Compile what cuts cells."""
    packing, _ = lattice()
    laguerre(packing.centers, packing.radii**2, packing.size, periodic=packing.periodic)


def multigrid():
    """Compile the preconditioner of large networks."""
    network, _ = _network()
    diagonal = np.bincount(np.repeat(np.arange(len(network.volumes)), np.diff(network.indptr)), network.conductance)
    r, z = np.ones_like(diagonal), np.empty_like(diagonal)
    preconditioner(links_of(network), 1.01 * diagonal)(r, 1.0, z)


def steady():
    """Compile the balance of heat, the steps that large networks take, and what a field is read off with."""
    network, scene = _network()
    # The linear start is exact: no iteration, and none is compiled.
    solution = solve_checked(network, scene, solver="cg", tolerance=TOLERANCE)
    field_of(scene, network, solution, stats={})
    x, r = np.ones_like(solution.temperature), np.ones_like(solution.temperature)
    apply(links_of(network), x, x, r)
    advance(dot(x, r), x, r, x.copy(), r.copy())


# The longest first. The second process begins there, the first one at the other end.
PARTS = (cells, multigrid, steady)


def parts_of(law, particles: int, *, steady_state: bool = True):
    """What a first solve of so many particles needs from a second process.

    That is nothing where facets do not bound cells, and where few particles are not packed: what these need is compiled
    before another process would begin.
    """
    if not law.cells or (law.conforming and particles <= FEW // 2):
        return ()
    large = (multigrid,) if particles > AMG_UNKNOWNS else ()
    return (cells, *large, steady) if steady_state else (cells,)


def lattice():
    """A simple cubic packing of a unit box between walls and the facets of its cells, as `laguerre` would give them."""
    at = (np.arange(SIDE) + 0.5) / SIDE
    centers = np.stack(np.meshgrid(at, at, at, indexing="ij"), axis=-1).reshape(-1, 3)
    n, number = SIDE**3, np.arange(SIDE**3).reshape((SIDE,) * 3)
    pairs = [
        (np.take(number, range(SIDE - 1), k).ravel(), np.take(number, range(1, SIDE), k).ravel()) for k in range(3)
    ]
    row, other = (np.concatenate([a for pair in pairs for a in pair[::step]]) for step in (1, -1))
    order = np.lexsort((other, row))
    links, walls = len(row), 6 * SIDE**2
    wall = np.concatenate([np.take(number, end, k).ravel() for k in range(3) for end in (0, -1)])
    facets = Facets(
        indptr=np.concatenate([[0], np.cumsum(np.bincount(row, minlength=n))]),
        indices=other[order].astype(np.uint32),
        image=np.full(links, 13, np.uint8),
        area=np.full(links, SIDE**-2.0),
        distance=np.full(links, 0.5 / SIDE),
        wall_particle=wall,
        wall_side=np.repeat(np.arange(6), SIDE**2),
        wall_area=np.full(walls, SIDE**-2.0),
        wall_distance=np.full(walls, 0.5 / SIDE),
        volumes=np.full(n, SIDE**-3.0),
    )
    radii = np.full(n, 0.5 / SIDE)
    return Packing(centers, radii, np.ones(3), np.zeros(3, dtype=bool), {"algorithm": "lattice"}), facets


def _network():
    scene = Scene(size=(1.0, 1.0, 1.0), matrix=Material(1.0), walls={"y-": 0.0, "y+": 1.0})
    packing, facets = lattice()
    return connect(packing, facets, np.zeros(packing.number, dtype=np.int64), scene.conductivities), scene


def _end_with_caller():
    """End this process as soon as the one that started it closes its pipe, or ends."""
    sys.stdin.buffer.read()
    os._exit(1)


if __name__ == "__main__":
    threading.Thread(target=_end_with_caller, daemon=True).start()
    work_off(sys.argv[1], [part for part in PARTS if part.__name__ in sys.argv[2:]])
