"""Where a row comes from: code, commit, machine, threads, versions. A row is reused only if these still hold."""

from __future__ import annotations

import ast
import copy
import hashlib
import os
import platform
import subprocess
import sys
from datetime import datetime, timezone
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from demheat.machine import host, machine
from studies.harness.methods import path_of
from studies.harness.threads import threads

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("demheat", "references", "benchmark", "studies")
LIBRARIES = ("numpy", "scipy", "numba", "pyamg", "scikit-fem", "gmsh", "pyfftw", "multivoro")
# What must agree for a stored row to stand for a new one.
SAME = ("code", "machine", "threads", "versions")
# The same where only its numbers count, not its costs: rows may come from several machines.
ANYWHERE = ("code", "versions")
# Names of a module that no number depends on, and modules of such: what methods declare, and this one, by whose hash
# a row may name what it keeps on disk.
DESCRIBING = {"__all__", "__version__", "METHODS"}
APART = ("demheat.method", "studies.harness.provenance")


def provenance(study, case):
    """Columns that say where a row comes from.

    Parameters
    ----------
    study : module
    case : dict
        Its "method", if any, names what the row loads, see `module_of`.
    """
    return {
        "code": code_of(study, case),
        "commit": commit(),
        "when": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "machine": machine(),
        "host": host(),
        "threads": threads(),
        "versions": versions(),
        "load": round(os.getloadavg()[0], 2),
    }


def code_of(study, case):
    """Hash of the source that a case runs.

    Parameters
    ----------
    study : module
    case : mapping
        Its "method", if any, names what the row loads, see `module_of`.
    """
    return code_hash(study.__file__, module_of(study, case.get("method", "")))


def guest_case(study, key):
    """Case of a method that is not ours, by its key; None if the study takes no such, or it is no such key.

    Parameters
    ----------
    study : module
    key : str
    """
    return study.guest_case(key) if hasattr(study, "guest_case") else None


def row_environment():
    """Environment of a row's process: one thread count for all, waiting threads that do not spin, no helper."""
    count = str(threads())
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


@cache
def commit():
    """Short hash of the checked-out commit, with "+" if the packages differ from it; empty outside a repository."""
    try:
        head = _git("rev-parse", "--short=10", "HEAD")
        return head + ("+" if _git("status", "--porcelain", "--", *PACKAGES) else "")
    except (OSError, subprocess.CalledProcessError):
        return ""


def _git(*words):
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def module_of(study, method):
    """Path of the module that a case means by its "method"; rows keep the name, so that the module may move.

    A name is that of a method, a module of `references` or `demheat`, or what the study's own `MODULES` says of it.

    Parameters
    ----------
    study : module
    method : str

    Returns
    -------
    str
        Empty without a method.

    Raises
    ------
    ValueError
        If there is no such module.
    """
    path = getattr(study, "MODULES", {}).get(method) or path_of(method)
    if method and not _file_of(path):
        raise ValueError(f"method = {method!r} of {study.__name__}: neither a method nor in its MODULES")
    return path


@cache
def code_hash(study_file, module=""):
    """Hash of the source that a row runs, 12 hexadecimal digits.

    Covers what `run` and `warm_up` of the study reach inside the study module, and every module of ours that they or
    the named one import, directly or not, but this one. Comments, docstrings, layout, imports of ours and what a method
    declares of itself do not count, nor where a file lies: neither moving a module nor drawing a figure anew must
    repeat hours of solves.

    Parameters
    ----------
    study_file : path
    module : str
        Path of the module that the case names, if any.
    """
    study_file = Path(study_file)
    used = _run_by(_parse(study_file))
    texts, seen = {_text(used)}, set()
    queue = [*_imported(used), (module, True)]
    while queue:
        name, deep = queue.pop()
        if (name, deep) in seen:
            continue
        seen.add((name, deep))
        path = _file_of(name)
        # Of a study that is a package its own parts import no more than `_reached` found.
        own = path == study_file and not deep
        if path is None or name in APART or own:
            continue
        tree = _parse(path)
        texts.add(_text(tuple(tree.body)))
        queue += _needed(tree, deep)
    return hashlib.sha256("\n".join(sorted(texts - {""})).encode()).hexdigest()[:12]


@cache
def _parse(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in _statements(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            del node.body[0]
    return tree


def _statements(node):
    """A statement, or a module, and all statements inside: a twelfth of what `ast.walk` visits."""
    yield node
    for part in ("body", "orelse", "handlers", "finalbody", "cases"):
        for inner in getattr(node, part, ()):
            yield from _statements(inner)


# What is made of trees is kept as long as they are: a module counts in a hundred hashes.
@cache
def _text(nodes):
    """Statements as text, without imports of ours and what only describes a module (`__all__`, `METHODS`)."""
    return "\n".join(filter(None, (_dump(node) for node in nodes if not _bound(node) & DESCRIBING)))


def _dump(node):
    """One statement as text; empty if it is an import of ours."""
    kept = _Moved().visit(copy.deepcopy(node)) if _imports_in(node) else node
    return "" if kept is None else spelled(kept)


def spelled(node):
    """Syntax as text, alike on every Python: what is empty is left out, as newer ones have parts that older ones lack.

    Parameters
    ----------
    node : ast.AST, list, or what a leaf holds
    """
    if isinstance(node, list):
        return f"[{', '.join(map(spelled, node))}]"
    if not isinstance(node, ast.AST):
        return repr(node)
    parts = ((name, getattr(node, name, None)) for name in node._fields)
    said = (f"{name}={spelled(part)}" for name, part in parts if part is not None and part != [])
    return f"{type(node).__name__}({', '.join(said)})"


@cache
def _imports_in(node):
    """Import statements inside another one."""
    return [part for part in _statements(node) if isinstance(part, ast.Import | ast.ImportFrom)]


class _Moved(ast.NodeTransformer):
    """Takes out imports of ours: they say where a module lies, not what it does."""

    def visit_Import(self, node):  # noqa: N802
        return None if any(alias.name.split(".")[0] in PACKAGES for alias in node.names) else node

    def visit_ImportFrom(self, node):  # noqa: N802
        return None if (node.module or "").split(".")[0] in PACKAGES else node


@cache
def _run_by(tree):
    """Top-level statements of a study that a row uses."""
    return tuple(_reached(tree.body, ("run", "warm_up")))


def _reached(body, roots):
    """Top-level statements that the named functions use, directly or not, in source order."""
    wanted, done = set(roots), set()
    while True:
        hit = [node for node in body if id(node) not in done and wanted & _bound(node)]
        if not hit:
            return [node for node in body if id(node) in done]
        for node in hit:
            done.add(id(node))
            wanted |= {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def _bound(node):
    """Names that a top-level statement defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    if isinstance(node, ast.Import | ast.ImportFrom):
        return {(alias.asname or alias.name).split(".")[0] for alias in node.names}
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)}


@cache
def _needed(tree, deep):
    """Imports of ours in a module; of a package that one of its modules runs, those that this makes it execute."""
    return _imported([tree] if deep else [node for node in tree.body if not isinstance(node, ast.FunctionDef)])


def _imported(nodes):
    """Pairs (module name, whether all of it counts) of the imports of ours inside some statements."""
    names = []
    for node in (part for top in nodes for part in _imports_in(top)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        else:
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            names += [name if _file_of(name) else node.module for name in inner]
    names = [name for name in names if name.split(".")[0] in PACKAGES]
    parents = {name.rsplit(".", k)[0] for name in names for k in range(1, name.count(".") + 1)}
    return [*((name, True) for name in names), *((name, False) for name in parents)]


def _file_of(name):
    """Path of a module of ours, None for any other name; a method may lie elsewhere on Python's path."""
    return _found(name, ROOT, *sys.path) if name.split(".")[0] in PACKAGES else None


@cache
def _found(name, *folders):
    """First file of a module in some folders. Kept: what a row runs imports hundreds of names, most of no module."""
    bases = (Path(folder).joinpath(*name.split(".")) for folder in folders)
    return next((p for base in bases for p in (base / "__init__.py", base.with_suffix(".py")) if p.is_file()), None)
