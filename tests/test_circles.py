"""No circle of modules that import each other, nor of folders."""

import pytest
from imported import MODULES, imports, imports_of


def edges():
    """Pairs (module, module of ours that it imports)."""
    pairs = [(name, target) for name in MODULES for target in imports_of(name)]
    return [(name, target) for name, target in pairs if target in MODULES and target != name]


def circle(pairs):
    """Names on some circle of a directed graph, and what leads into or out of it; empty without one."""
    pairs = set(pairs)
    while True:
        between = {a for a, _ in pairs} & {b for _, b in pairs}
        kept = {(a, b) for a, b in pairs if a in between and b in between}
        if kept == pairs:
            return sorted(between)
        pairs = kept


def side_by_side(pairs):
    """For every folder the arrows between its members, modules and folders: those of all that lies in them.

    The packages are one house, under "": witnesses stand on the engine's nouns, and what chooses among them on both.
    """
    found = {}
    for name, target in pairs:
        a, b = name.split("."), target.split(".")
        if a[:2] != b[:2]:
            found.setdefault("", set()).add((".".join(a[:2]), ".".join(b[:2])))
        same = next((k for k, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), None)
        # A front imports what it shows: that is no arrow between members.
        if same:
            members = ".".join(a[: same + 1]), ".".join(b[: same + 1])
            found.setdefault(".".join(a[:same]), set()).add(members)
    return found


def test_no_circle_of_modules_or_folders():
    pairs = edges()
    found = circle(pairs)
    assert not found, f"modules that import each other: {', '.join(found)}"
    folders = {folder or "the packages": circle(within) for folder, within in side_by_side(pairs).items()}
    told = "; ".join(f"in {folder} {', '.join(found)}" for folder, found in folders.items() if found)
    assert not told, f"folders that import each other: {told}"


@pytest.mark.parametrize(
    "source",
    [
        "def f():\n    from demheat.terminal.pictures import plot_field",
        "import_module('demheat.terminal.pictures').plot_field",
        "importlib.import_module(name='demheat.terminal.pictures')",
        "__import__('demheat.terminal.pictures')",
        "lazy_names(__name__, {'demheat.terminal.pictures': ('plot_field',)})",
        "HOMES = {'picture': 'demheat.terminal.pictures'}\ndef f(kind):\n    return import_module(HOMES[kind])",
        "import_module(f'demheat.terminal.pictures.{name}')",
    ],
)
def test_imports_are_seen_in_functions_and_by_name(source):
    modules = MODULES | {"demheat.terminal.pictures.part": None}
    assert {name.removesuffix(".part") for name in imports("demheat.field", source, modules)} == {
        "demheat.terminal.pictures"
    }


def test_what_cannot_be_read_is_refused():
    with pytest.raises(ValueError, match="demheat.field, line 1: what is imported cannot be read"):
        imports("demheat.field", "import_module(name)")


def test_a_circle_is_seen():
    assert circle([("a", "b"), ("b", "c"), ("c", "d")]) == []
    assert circle([("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")]) == ["b", "c"]
    # No circle of modules, but one of folders.
    pairs = [("p.a.one", "p.b.one"), ("p.b.two", "p.a.two"), ("p", "p.a.one"), ("p.a.one", "p.a.three")]
    assert circle(pairs) == [] and circle(side_by_side(pairs)["p"]) == ["p.a", "p.b"]
