import fcntl
import gc
import hashlib
import os
import pickle
import tempfile
from pathlib import Path

import pytest

# Tests make their own packings and never touch the user's; set before anything reads it.
os.environ.setdefault("DEMHEAT_CACHE", tempfile.mkdtemp(prefix="demheat-test-cache-"))
# Second processes that compile would run beside the tests.
os.environ["DEMHEAT_WARM"] = "0"
# Workers share the processors: one thread each, of libraries and (below) of Numba. Tests of two threads ask for them.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Where kernels and packings are kept.
FOLDERS = ("NUMBA_CACHE_DIR", "DEMHEAT_CACHE", "XDG_CACHE_HOME")
# Python looks for unreachable cycles whenever 700 objects are new; compiling makes a million that live on.
gc.set_threshold(50_000, 20, 20)


def shared_folder(factory, name):
    """A folder of this run that all workers see."""
    root = factory.getbasetemp()
    folder = (root.parent if "PYTEST_XDIST_WORKER" in os.environ else root) / name
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session", autouse=True)
def meshed_once(tmp_path_factory):
    """A mesh that several tests or workers ask for is made by one of them; tests of meshing make each anew."""
    from references.mesh import apart, gmsh_session

    folder, made = shared_folder(tmp_path_factory, "meshes"), gmsh_session.run_apart

    def kept(function, *arguments, done, **limits):
        if os.environ["PYTEST_CURRENT_TEST"].startswith("tests/references/mesh"):
            return made(function, *arguments, done=done, **limits)
        # What is asked for says all: the mesher's process sees nothing else.
        path = folder / hashlib.sha256(pickle.dumps((function, arguments))).hexdigest()
        if not path.exists():
            answer = pickle.dumps(made(function, *arguments, done=done, **limits))
            with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
                file.write(answer)
            os.replace(file.name, path)
        done(apart.LAST)
        return pickle.loads(path.read_bytes())

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gmsh_session, "run_apart", kept)
        yield


@pytest.fixture(scope="session", autouse=True)
def compiled_once(tmp_path_factory):
    """One thread; and what two workers need compiled is compiled by one of them, the other waits and loads it."""
    import numba
    from numba.core.dispatcher import Dispatcher

    import demheat.runtime.threads  # noqa: F401 - chooses the layer before threads start

    numba.set_num_threads(1)
    locks = shared_folder(tmp_path_factory, "compiling")
    compiled = Dispatcher.compile

    def in_turn(self, signature):
        # Kernels call kernels in no circle, and nor do those who wait.
        with (locks / f"{Path(self.py_func.__code__.co_filename).stem}.{self.py_func.__qualname__}").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            return compiled(self, signature)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Dispatcher, "compile", in_turn)
        yield


@pytest.fixture(scope="module", autouse=True)
def settled():
    """What is loaded by now stays: a search for garbage, which every measured cost begins with, passes it over.

    And no module leaves other folders behind: those after it would compile and pack anew, for minutes.
    """
    gc.collect()
    gc.freeze()
    before = [os.environ.get(name) for name in FOLDERS]
    yield
    assert [os.environ.get(name) for name in FOLDERS] == before
