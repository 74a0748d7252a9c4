"""Where a row comes from: commit, day, machine, threads, versions."""

import ast
import hashlib
import os
import platform
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from demheat.runtime.machine import here
from studies.harness.making import EXCEPT, paths_of
from studies.harness.methods import path_of

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("demheat", "references", "benchmark", "studies")
# Of a study: sentences why claims fail, or have room.
WORDS = ("FAILS", "REASONS")
LIBRARIES = ("numpy", "scipy", "numba", "pyamg", "scikit-fem", "gmsh", "pyfftw", "multivoro")
# What must agree, besides the commit, for a stored row to stand for a new one without a replay.
SAME = ("machine", "threads", "versions")
# The same where only its numbers count, not its costs: rows may come from several machines.
ANYWHERE = ("versions",)


def provenance(study):
    """Columns that say where a row of a study comes from; each stands in `store.TAIL`, or replays would compare it."""
    return {
        "commit": commit(study.__file__),
        **here(),
        "threads": threads(),
        "versions": versions(),
        "load": round(os.getloadavg()[0], 2),
    }


def threads():
    """Threads a row may use: NUMBA_NUM_THREADS where set, else every processor this process may use."""
    return int(os.environ.get("NUMBA_NUM_THREADS") or len(os.sched_getaffinity(0)))


def guest_case(study, key):
    """Case of a method that is not ours, by its key; None if the study takes no such, or it is no such key."""
    return study.guest_case(key) if hasattr(study, "guest_case") else None


def row_environment(count=None):
    """Environment of a row's process: one thread count for all, waiting threads that do not spin, no helper."""
    count = str(count or threads())
    return {
        **os.environ,
        "NUMBA_THREADING_LAYER": "workqueue",
        "OMP_WAIT_POLICY": "PASSIVE",
        "DEMHEAT_WARM": "0",
        "NUMBA_NUM_THREADS": count,
        "OMP_NUM_THREADS": count,
        "OPENBLAS_NUM_THREADS": count,
    }


@cache
def versions():
    """Versions of Python and of the libraries that compute, in one line."""
    found = [f"python {platform.python_version()}"]
    for name in LIBRARIES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(f"{name} absent")
    return ", ".join(found)


def commit(file=""):
    """Short hash of the checked-out commit; "+" and a digest of what differs from it follow where that makes rows.

    Of a study's file what makes its rows counts (`making`); without, and for studies of others, all packages do.
    """
    changed = _differences(_paths(file)) + (Path(file).read_bytes() if _strange(file) else b"")
    return _head() + (f"+{hashlib.sha256(changed).hexdigest()[:6]}" if changed else "")


def of_this_code(stored, file=""):
    """Whether what makes a study's rows does what it did at a commit of a row: what that has made is this code's."""
    known = bool(stored) and "+" not in stored and not _strange(file)
    return bool(stored) and (stored == commit(file) or (known and _alike(stored, _paths(file))))


def _paths(file):
    """What of the packages makes the rows of a study's file, as git is asked for it."""
    if not (Path(file).name and Path(file).is_relative_to(ROOT / "studies")):
        return PACKAGES
    return (*(name for name in PACKAGES if name != "studies"), *paths_of(ROOT, str(file)))


def _strange(file):
    """Whether a study's file is none of the packages'."""
    return bool(Path(file).name) and not any(Path(file).is_relative_to(ROOT / name) for name in PACKAGES)


@cache
def _alike(stored, paths):
    """Whether nothing but words has changed there since a commit; not if it is unknown."""
    try:
        told = _git("diff", "--name-status", "--no-renames", "-z", stored, "--", *paths).decode().split("\0")
        changed = {path: how for how, path in zip(told[::2], told[1::2], strict=False)}
        if _untracked(paths) or any(how != "M" or not path.endswith(".py") for path, how in changed.items()):
            return False
        return all(_works_alike(stored, path) for path in changed)
    except (OSError, subprocess.CalledProcessError, SyntaxError):
        return False


@cache
def _works_alike(stored, path):
    return _work(_git("show", f"{stored}:{path}")) == _work((ROOT / path).read_bytes())


def _work(source):
    """A module without its comments, docstrings and sentences about claims."""
    tree = ast.parse(source)
    tree.body = [node for node in tree.body if not _told(node)]
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            del node.body[0]
    return ast.dump(tree)


def _told(node):
    """Whether a statement makes sentences about claims and nothing else."""
    return isinstance(node, ast.Assign) and all(getattr(each, "id", None) in WORDS for each in node.targets)


@cache
def _head():
    """The checked-out commit; empty outside a repository."""
    try:
        return _git("rev-parse", "--short=10", "HEAD").decode().strip()
    except (OSError, subprocess.CalledProcessError):
        return ""


@cache
def _differences(paths):
    """What there is at no commit, as bytes: of one process, which has loaded its modules once."""
    try:
        found = _git("diff", "HEAD", "--", *paths)
        for name in _untracked(paths):
            found += name + (ROOT / name.decode()).read_bytes()
        return found
    except (OSError, subprocess.CalledProcessError):
        # Outside a repository the source itself must tell.
        homes = [ROOT / name for name in paths if not name.startswith(EXCEPT)]
        files = {path for home in homes for path in (home, *home.rglob("*.py")) if path.is_file()}
        out = [ROOT / name.removeprefix(EXCEPT) for name in paths if name.startswith(EXCEPT)]
        files = {path for path in files if not any(path.is_relative_to(each) for each in out)}
        return b"".join(path.read_bytes() for path in sorted(files))


def _untracked(paths):
    names = _git("ls-files", "--others", "--exclude-standard", "-z", "--", *paths).split(b"\0")
    return sorted(filter(None, names))


def _git(*words):
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=True).stdout


def module_of(study, method):
    """Path of the module that a case means by its "method"; rows keep the name, so that the module may move.

    A name is that of a method, a module of `references` or `demheat`, or what the study's own `MODULES` says of it.
    """
    from importlib.util import find_spec

    path = getattr(study, "MODULES", {}).get(method) or path_of(method)
    if method and not (path and find_spec(path)):
        raise ValueError(f"method = {method!r} of {study.__name__}: neither a method nor in its MODULES")
    return path
