"""gmsh in a process of its own: what crashes, hangs, runs away, is interrupted or forked; the same bits each time."""

import math
import os
import signal
import subprocess
import sys
import threading
import time
import types
from pathlib import Path

import meshed_here
import numpy as np
import pytest

from demheat.runtime.process_state import cpu_seconds
from demheat.scene import Layer, Material, Scene, Sphere
from references import mesh
from references.mesh import apart, cad, sizes
from references.mesh import round as round_bodies
from references.mesh.apart import run_apart

ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def with_gmsh():
    meshed_here.gmsh_or_skip()


def ball(radius=1 / 3):
    return Scene((1.0,) * 3, Material(1.0), [Sphere((0.5,) * 3, radius, Material(2.0))], walls={"x-": 0.0, "x+": 1.0})


def call(function, *arguments):
    shares = []
    return run_apart(function, *arguments, seconds=1.0, done=shares.append), shares


def test_answers_and_shares():
    answer, shares = call(math.sqrt, 4.0)
    assert answer == 2.0 and shares == sorted(shares)
    # Two signs of life at least; more than the seconds that were estimated stay below 1.
    _, shares = call(time.sleep, 0.7)
    assert len(shares) >= 2 and all(0 < share <= 0.95 for share in shares)


def test_errors_are_those_of_the_function():
    with pytest.raises(ValueError, match="math domain error|nonnegative"):
        call(math.sqrt, -1.0)
    with pytest.raises(ZeroDivisionError):
        call(divmod, 1, 0)


def test_what_is_printed_there_does_no_harm(capfd):
    # A new worker, which writes where this process does now.
    apart._end_all()
    assert call(print, "loud")[0] is None
    assert capfd.readouterr() == ("", "loud\n")


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_crash_is_an_error():
    # The child's own signals: as if gmsh read beyond its memory, and as if the system took the memory back.
    with pytest.raises(RuntimeError, match="crashed.*-6"):
        call(os.abort)
    with pytest.raises(MemoryError, match="larger size"):
        call(signal.raise_signal, signal.SIGKILL)
    with pytest.raises(RuntimeError, match="status 3"):
        call(os._exit, 3)


@pytest.mark.skipif(sys.platform != "linux", reason="limits of addresses")
def test_what_runs_away_is_stopped():
    # 8 GiB where 4 are allowed: not the machine's memory is at an end, but the process's.
    with pytest.raises(MemoryError) as caught:
        run_apart(np.empty, 2**30, seconds=1.0, done=lambda share: None, memory=2**32)
    assert "larger size" not in str(caught.value)


@pytest.mark.skipif(os.name != "posix", reason="limits of processor time")
def test_what_hangs_is_stopped_and_not_tried_again():
    with pytest.raises(RuntimeError, match="stopped after 1 s of processor time") as caught:
        run_apart(_hang, seconds=1.0, done=lambda share: None, most=1.0)
    # Of a kind that meshing at another size does not follow.
    assert type(caught.value) is not RuntimeError


def _hang():
    while True:
        pass


def test_what_ends_the_wait_ends_the_work():
    def tell(share):
        raise KeyError("enough")

    before = set(apart._workers)
    with pytest.raises(KeyError, match="enough"):
        run_apart(time.sleep, 600.0, seconds=1.0, done=tell)
    assert not apart._idle and set(apart._workers) < before | {None}
    assert call(math.sqrt, 9.0)[0] == 3.0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="one worker for one mesh")
def test_one_worker_is_kept_and_its_time_is_counted():
    assert call(os.getsid, 0)[0] == call(os.getsid, 0)[0] == apart._idle[0].pid
    assert call(os.getpid)[0] != call(os.getpid)[0]
    before = cpu_seconds()
    call(_burn)
    # A tenth of a second, told in hundredths.
    assert cpu_seconds() - before > 0.05
    # It may be killed: another one is begun.
    apart._idle[0].kill()
    apart._idle[0].wait()
    assert call(math.sqrt, 4.0)[0] == 2.0 and len(apart._workers) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="one worker for one mesh")
def test_memory_begins_where_it_did_before():
    """gmsh's meshes may go by where its memory lies."""
    first = _places()
    for size in (10, 10**4, 10**6):
        # What is read and answered is kept nowhere.
        call(bytes, size)
        call(len, bytes(size))
        assert _places() == first


def _places():
    """Where small and large objects come to lie that a fork has read."""
    return [call(id, bytes(size))[0] for size in (50, 5000, 100_000)]


def _burn():
    end = time.process_time() + 0.1
    while time.process_time() < end:
        pass


def test_threads_do_not_mix_their_answers():
    found = {}

    def work(k):
        found[k] = [call(divmod, 100 * k + i, 7)[0] for i in range(5)]

    threads = [threading.Thread(target=work, args=(k,)) for k in range(3)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert found == {k: [divmod(100 * k + i, 7) for i in range(5)] for k in range(3)}
    assert len(apart._idle) <= 1


def test_shapes_that_only_this_process_has_are_refused(monkeypatch):
    module = types.ModuleType("nowhere")
    monkeypatch.setitem(sys.modules, "nowhere", module)
    module.Mine = type("Mine", (), {"__module__": "nowhere"})
    with pytest.raises(NotImplementedError, match="shape of one's own must be in a module.*nowhere"):
        call(print, module.Mine())


# gmsh reads there what it has not written: in the caller's process it crashed within five meshes, or made others.
COARSE = Scene(
    (2.184e-3, 0.232e-3, 0.232e-3), Material(1.0, 1.0, 1.0), walls={"x-": 1.0}, initial=0.0, domain="cylinder-x"
)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is filled by the C library of Linux")
@pytest.mark.slow
def test_a_mesh_is_the_same_whatever_was_meshed_before():
    first = mesh.make_round(COARSE, size=1.2e-4, order=2)
    mesh.make(ball(), size=0.3, order=1)
    for _ in range(2):
        again = mesh.make_round(COARSE, size=1.2e-4, order=2)
        assert again.stats["size"] == first.stats["size"]
        assert np.array_equal(again.points, first.points) and np.array_equal(again.cells, first.cells)


def test_crashes_name_the_scene(monkeypatch):
    monkeypatch.setattr(round_bodies, "_tetrahedra", os.abort)
    monkeypatch.setattr(round_bodies, "call_gmsh", lambda function, *_, **how: call(function))
    with pytest.raises(RuntimeError, match=r"could not mesh the cylinder-x of \(0.002184, .* 4 sizes .*crashed.*-6"):
        mesh.make_round(COARSE, size=1e-4, order=1)


def test_bodies_that_are_not_filled_are_refused(monkeypatch):
    """Elements with all their corners on the surface, as most are here: only the triangles there tell the gap."""
    there, made = round_bodies.call_gmsh, []

    def loses(*arguments, **how):
        # One mesh for all sizes that are tried: each has its gap.
        made.append(made[0] if made else there(*arguments, **how))
        points, cells, phase, surface = made[0]
        return points, cells[1:], phase[1:], surface

    monkeypatch.setattr(round_bodies, "call_gmsh", loses)
    with pytest.raises(RuntimeError, match="4 sizes.*do not fill what the triangles on the surface enclose"):
        mesh.make_round(COARSE, size=1e-4, order=2)


SCRIPT = """
import subprocess
class Told(subprocess.Popen):
    def __init__(self, *a, **k):
        super().__init__(*a, **k)
        print(self.pid, flush=True)
subprocess.Popen = Told
from demheat.runtime import progress
from demheat.scene import Material, Scene, Sphere
from references import fem
progress.SILENT = 0.0
progress.on_progress(lambda report: print(report.stage, flush=True))
sphere = Sphere((0.5,) * 3, 1 / 3, Material(2.0))
try:
    # Half a minute and more.
    fem.solve(Scene((1.0,) * 3, Material(1.0), [sphere], walls={"x-": 0.0, "x+": 1.0}), size=0.022)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_ends_meshing_and_the_mesher():
    # Where SIGINT is ignored, as in the background of a script, children would ignore it too.
    how = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", SCRIPT], cwd=ROOT, **how) as parent:
        child = int(parent.stdout.readline())
        assert parent.stdout.readline() == "mesh\n"
        parent.send_signal(signal.SIGINT)
        rest = parent.stdout.read().split("\n")
    assert parent.returncode == 0
    # Not one stage after the mesh: it was not waited for.
    assert set(rest) == {"mesh", "interrupted", ""} or set(rest) == {"interrupted", ""}
    assert ended(child)


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_the_mesher_ends_with_its_parent():
    begun, _ = SCRIPT.split("from demheat.runtime import progress")
    script = (
        begun
        + """
import os, time
from references.mesh.apart import run_apart
run_apart(time.sleep, 600.0, seconds=1.0, done=lambda share: os.kill(os.getpid(), 9))
"""
    )
    with subprocess.Popen([sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
    assert parent.returncode == -signal.SIGKILL
    assert ended(child)


def ended(group):
    """Whether all processes of a group end soon."""
    for _ in range(500):
        if not living(group):
            return True
        time.sleep(0.02)
    return False


def living(group):
    """Whether processes of a group live; nobody may be left to reap one that has ended."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    stats = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            stats.append(path.read_text().rpartition(")")[2].split())
        except (FileNotFoundError, ProcessLookupError):
            pass
    return not stats or any(state != "Z" and int(own) == group for state, _, own, *_ in stats)


FORKS = """
import math, os, threading, time
from references.mesh.apart import run_apart
def root(x): return run_apart(math.sqrt, x, seconds=1.0, done=lambda share: None)
def roots(): assert [root(float(i * i)) for i in mine] == mine
mine = list(range(20))
root(4.0)
# A worker waits: it is the parent's, whatever its child does.
children = [os.fork()]
if children == [0]:
    mine = list(range(50, 70))
    roots()
    os._exit(0)
roots()
found = []
def slow(): found.append(run_apart(time.sleep, 0.5, seconds=1.0, done=lambda share: None))
workers = [threading.Thread(target=each) for each in (roots, slow)]
for worker in workers: worker.start()
time.sleep(0.2)
# One works: a child that ends as processes do must not end it.
children.append(os.fork())
if children[-1] == 0:
    raise SystemExit
for _ in range(2):
    children.append(os.fork())
    if children[-1] == 0:
        try:
            roots()
            os._exit(0)
        finally:
            os._exit(1)
for worker in workers: worker.join()
ends = [os.waitpid(child, 0)[1] for child in children]
assert ends == [0] * 4 and found == [None] and root(9.0) == 3.0, ends
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_children_forked_while_threads_mesh():
    # Python warns, since 3.12, of any fork while there are threads.
    words = [sys.executable, "-W", "error", "-W", "ignore::DeprecationWarning", "-c", FORKS]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_hopeless_meshes_are_refused_before_they_are_begun(monkeypatch):
    monkeypatch.setattr(cad, "attempts", None)
    monkeypatch.setattr(sizes, "free_memory", lambda: 2.0**30)
    with pytest.raises(ValueError, match=r"size = 0.02 m: about 5\.6e\+05 tetrahedra.* 2 GiB;.* >= 0.024 m, or take"):
        mesh.make(ball(), size=0.02)
    # Small spheres ask for more elements than the size alone: refused, too, at the default size.
    tiny = [Sphere(((i + 0.5) / 9, (j + 0.5) / 9, 0.3), 0.01, Material(2.0)) for i in range(9) for j in range(9)]
    monkeypatch.setattr(sizes, "free_memory", lambda: 50e6)
    with pytest.raises(ValueError, match="size = .*must be >="):
        mesh.make(Scene((1.0,) * 3, Material(1.0), tiny, walls={"x-": 0.0, "x+": 1.0}), size=0.1, order=1)


@pytest.mark.parametrize(
    ("inclusion", "says"),
    [
        (Sphere((0.5,) * 3, 1e-30, Material(2.0)), "sphere of radius 1e-30 m at .*: too small for a mesh"),
        (Sphere((0.5,) * 3, 1e-6, Material(2.0)), "sphere of radius 1e-06 m"),
        (Layer(1, 0.5, 0.5 + 1e-15, Material(2.0)), "layer along axis 1 from 0.5 to .*: too thin to mesh"),
        (Layer(1, 0.0, 1e-300, Material(2.0)), "layer along axis 1"),
    ],
)
def test_what_gmsh_is_lost_in_is_refused_first(inclusion, says, monkeypatch):
    monkeypatch.setattr(cad, "attempts", None)
    with pytest.raises(NotImplementedError, match=says):
        mesh.make(Scene((1.0,) * 3, Material(1.0), [inclusion], gradient=(1.0, 0.0, 0.0)))


def test_pairs_looked_at_grow_like_the_spheres():
    """Lattices of ever more spheres: each has as many neighbours, whatever their number."""
    for n in (4, 8):
        places = (np.stack(np.meshgrid(*[np.arange(n)] * 3), axis=-1).reshape(-1, 3) + 0.5) / n
        outer, _ = sizes._near(places, np.full(n**3, 0.33 / n), 0.1 / n)
        # Of each pair one is counted, within 2 radii and a gap below sqrt(24) sizes, 1.15 distances: 6 neighbours.
        assert len(outer) == 3 * n**2 * (n - 1)
    # A few large ones among many small: each pair is found from the larger.
    rng = np.random.default_rng(0)
    outer, inner = sizes._near(rng.random((50, 3)), np.r_[0.3, np.full(49, 0.01)], 0.01)
    assert np.all(outer[np.flatnonzero(outer == 0)] == 0) and not np.any(inner == 0)
