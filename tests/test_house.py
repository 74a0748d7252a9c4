"""Rules of the house that can be read off the source: twins of kernels, arguments, docstrings, lengths of files."""

import ast
import inspect
import pydoc
import re
from functools import cache
from pathlib import Path

from demheat.scene.shapes.base import Shape

ROOT = Path(__file__).parents[1]
MOST_ARGUMENTS, MOST_LINES = 8, 410
# Functions whose keywords are not spelled yet.
STILL_HIDDEN = {
    "demheat/packing/cache.py: grown",
    "demheat/packing/cache.py: relaxed",
    "demheat/packing/dispersion.py: dispersion",
    "demheat/packing/dispersion.py: dispersion_scene",
    "demheat/packing/lsa.py: lsa",
    "demheat/packing/relax.py: relax",
}


@cache
def trees():
    """Sources by their paths; read when they are asked for, not by every process that lists the tests."""
    return {
        path.relative_to(ROOT): ast.parse(path.read_text(encoding="utf-8"))
        for package in ("demheat", "references", "benchmark", "studies")
        for path in sorted((ROOT / package).rglob("*.py"))
    }


def kernels():
    return {path: tree for path, tree in trees().items() if path.stem.endswith("kernels")}


def others():
    return {path: tree for path, tree in trees().items() if not path.stem.endswith("kernels")}


def compiled(function):
    return any("njit" in ast.dump(decorator) for decorator in function.decorator_list)


def public(tree):
    """Functions of a module and methods of its classes that have no leading underscore."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from (each for each in node.body if isinstance(each, ast.FunctionDef) and each.name[0] != "_")
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield node


def arguments(function):
    """What a caller must think of: all but knobs, which are asked for by name and have a default."""
    parts = function.args
    must = [each for each, default in zip(parts.kwonlyargs, parts.kw_defaults, strict=True) if default is None]
    return [each.arg for each in (*parts.posonlyargs, *parts.args, *must) if each.arg not in ("self", "cls")]


def twins():
    """Names that occur in tests marked `twin`: (module of kernels, name of one) by the imports of the test's file."""
    found = set()
    for path in (ROOT / "tests").rglob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        if "mark.twin" not in text:
            continue
        tree = ast.parse(text)
        modules = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    modules[alias.asname or alias.name] = f"{node.module}.{alias.name}"
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in modules:
                found.add(f"{modules[node.value.id]}.{node.attr}")
            elif isinstance(node, ast.Name) and node.id in modules:
                found.add(modules[node.id])
    return found


def test_every_public_kernel_has_a_slow_twin():
    named = {
        f"{'.'.join(path.with_suffix('').parts)}.{function.name}"
        for path, tree in kernels().items()
        for function in public(tree)
        if compiled(function)
    }
    assert len(named) > 50
    alone = sorted(named - twins())
    assert not alone, f"kernels without a slow twin in a test that is marked `twin`: {', '.join(alone)}"


def test_kernels_are_in_modules_of_kernels():
    loose = [f"{path}: {f.name}" for path, tree in others().items() for f in public(tree) if compiled(f)]
    assert not loose, f"compiled outside of a module whose name ends in `kernels`: {', '.join(loose)}"


def test_python_calls_no_kernel_that_has_no_way_in():
    """It would end the process: such kernels are private, and named by their own module only."""
    closed = {
        node.name
        for tree in kernels().values()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and any(ast.unparse(each) == "inner" for each in node.decorator_list)
    }
    assert len(closed) > 10 and all(name.startswith("_") for name in closed)
    texts = (path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py"))
    tests = (ast.parse(text) for text in texts if any(name in text for name in closed))
    for node in (node for tree in (*trees().values(), *tests) for node in ast.walk(tree)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").endswith("kernels"):
            assert not closed & {alias.name for alias in node.names}
        elif isinstance(node, ast.Attribute) and node.attr in closed:
            assert not ast.unparse(node.value).endswith("kernels")


def test_few_arguments():
    functions = [(path, f) for path, tree in others().items() for f in ast.walk(tree) if isinstance(f, ast.FunctionDef)]
    assert len(functions) > 3000
    assert [f"{path}: {f.name}" for path, f in functions if len(arguments(f)) > MOST_ARGUMENTS] == []


def test_knobs_are_spelled():
    """A reader, an editor and a type checker see what a function takes: none takes keywords to pass them on."""
    hidden = {
        f"{path}: {function.name}"
        for path, tree in trees().items()
        for function in public(tree)
        # The keywords of a study's `run` are those of its cases.
        if function.args.kwarg and path.parts[0] != "studies"
    }
    told = ", ".join(sorted(hidden ^ STILL_HIDDEN))
    assert not told, f"keywords that are passed on by **, or are no longer and stand in STILL_HIDDEN: {told}"


def shown_by_the_manual():
    """Functions and classes of the reference's pages, and what is public of these classes."""
    pages = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs" / "reference").glob("*.md"))
    for name in re.findall(r"^\.\. auto(?:function|class):: ([\w.]+)$", pages, re.MULTILINE):
        thing = pydoc.locate(name)
        yield name, thing
        if inspect.isclass(thing):
            own = ((each, value) for each, value in vars(thing).items() if each[0] != "_")
            yield from ((f"{name}.{each}", value) for each, value in own if inspect.isfunction(value))


def test_what_the_manual_shows_describes_its_parameters():
    """Units, shapes and errors belong to what users call; inside, one line, a name and a type say it."""
    inherited = {name for name, _ in inspect.getmembers(Shape)}
    shown = [each for each in shown_by_the_manual() if each[0].rpartition(".")[2] not in inherited]
    assert len(shown) > 130
    silent = [
        name
        for name, thing in shown
        if len(set(inspect.signature(thing).parameters) - {"self"}) >= 2
        and not re.search("(Parameters|Attributes)\n", thing.__doc__ or "")
    ]
    assert not silent, f"shown by the manual, without a section Parameters: {', '.join(silent)}"


def test_files_are_short():
    """A reader holds one idea at a time; what passes this is split by ideas."""
    lengths = {path: len((ROOT / path).read_text(encoding="utf-8").splitlines()) for path in trees()}
    long = [f"{path} ({n})" for path, n in lengths.items() if n > MOST_LINES]
    assert not long, f"files of more than {MOST_LINES} lines: {', '.join(long)}"


def test_nothing_that_a_reader_cannot_follow():
    """No numbers of a tracker."""
    for path in trees():
        text = (ROOT / path).read_text(encoding="utf-8").lower()
        assert not any(f"issue {n}" in text for n in range(10)), path
