"""Breaks are other programs, tried where tests are nearest, and what sees them is told."""

import ast
from pathlib import Path

import pytest
from tools import breaks
from tools.mutants import mutants

SOURCE = '''"""A text with 3 words."""

LIMIT: int = 4


def clipped(x: "float < 5", most=2.5, strict=False) -> "x + 1":
    """At most 1 + 1."""
    if not x <= LIMIT or strict:
        raise ValueError(f"x = {x}: more than {LIMIT + 1}")
    for k in range(LIMIT):
        x -= -k
    return min(x * most, 7)


class Thing:
    def __repr__(self):
        return str(1 + 2)
'''


def test_breaks_of_a_source():
    found = {(m.line, m.kind, *m.words()) for each in mutants(SOURCE) for m in each}
    assert found == {
        (3, "constant", "4", "5"),
        (3, "constant", "4", "3"),
        (6, "constant", "2.5", "5.0"),
        (6, "constant", "2.5", "1.25"),
        (6, "constant", "False", "True"),
        (8, "and-or", "not x <= LIMIT or strict", "(not x <= LIMIT and strict)"),
        (8, "dropped sign or not", "not x <= LIMIT", "(x <= LIMIT)"),
        (8, "compare", "x <= LIMIT", "(x < LIMIT)"),
        (8, "compare", "x <= LIMIT", "(x >= LIMIT)"),
        (9, "dropped statement", 'raise ValueError(f"x = {x}: more than {LIMIT + 1}")', "pass"),
        (10, "off by one", "range(LIMIT)", "(range(LIMIT - 1))"),
        (11, "arithmetic", "x -= -k", "x += -k"),
        (11, "dropped statement", "x -= -k", "pass"),
        (11, "dropped sign or not", "-k", "(k)"),
        (12, "other function", "min(x * most, 7)", "(max(x * most, 7))"),
        (12, "arithmetic", "x * most", "(x / most)"),
        (12, "constant", "7", "8"),
        (12, "constant", "7", "6"),
    }


def test_a_draw_is_repeated_and_begins_a_larger_one():
    few, many = (breaks.drawn(count, 5, packages=("demheat/scene",)) for count in (20, 60))
    assert many[:20] == few and len({each.key()[:3] for each in many}) > 40
    assert breaks.drawn(20, 6, packages=("demheat/scene",)) != few


@pytest.mark.parametrize(
    "module, first",
    [
        ("demheat/packing/twins/conforming.py", "tests/demheat/packing/twins/test_conforming.py"),
        ("demheat/dem/solver.py", "tests/demheat/test_dem.py"),
        ("references/voxels/kernels.py", "tests/references/voxels/test_voxel_kernels.py"),
        ("studies/harness/runner.py", "tests/studies/harness/test_runner.py"),
    ],
)
def test_the_nearest_tests_come_first(module, first):
    found = breaks.stages(Path(module))
    assert first in found[0]
    every = [name for group in found for name in group]
    assert len(every) == len(set(every)) and all((breaks.ROOT / name).is_file() for name in every)


THING = """def below(n):
    while n > 3:
        n -= 1
    return n


def unasked(n):
    return n * 0.5


def odd():
    return 2.0
"""
TESTS = """from pathlib import Path

from demheat import thing


def test_below():
    assert thing.below(9) == 3


def test_fails_in_the_sound_copy_too():
    assert thing.odd() == 2.0 and "sound" not in Path.cwd().name
"""


def test_what_sees_a_break_is_told_and_kept(tmp_path):
    tree, out = tmp_path / "tree", tmp_path / "table.csv"
    for folder in ("demheat", "tests/demheat"):
        (tree / folder).mkdir(parents=True)
    (tree / "demheat" / "thing.py").write_text(THING)
    (tree / "tests" / "demheat" / "test_thing.py").write_text(TESTS)
    drawn = {each.mutant.words(): each for seed in range(9) for each in breaks.drawn(99, seed, tree, ("demheat",))}
    wanted = [("3", "4"), ("n -= 1", "pass"), ("0.5", "1.0"), ("2.0", "4.0")]
    chosen = [drawn[words] for words in wanted]
    breaks.run(chosen, out, root=tree, limit=1.0)
    test = "tests/demheat/test_thing.py::"
    table = breaks.rows(out)
    assert [(row["before"], row["after"], row["caught"], row["by"]) for row in table] == [
        ("3", "4", "yes", test + "test_below"),
        ("n -= 1", "pass", "yes", test + "test_below (hang)"),
        ("0.5", "1.0", "no", ""),
        ("2.0", "4.0", "no", ""),  # what sees it fails in the sound copy too
    ]
    breaks.run(chosen, out, root=tree, limit=1.0)
    assert breaks.rows(out) == table


LIST = """module,before,after,meaning
demheat/thing.py,n * 0.5,n * 0.25,a quarter
demheat/thing.py,n,m,stands there often
demheat/other.py,n * 0.5,n,no such file
"""


def test_breaks_of_a_list_are_asked_of_all_tests(tmp_path):
    tree, out = tmp_path / "tree", tmp_path / "table.csv"
    for folder in ("demheat", "tests/demheat", "tests/far"):
        (tree / folder).mkdir(parents=True)
    (tree / "demheat" / "thing.py").write_text(THING)
    (tree / "tests" / "demheat" / "test_thing.py").write_text(TESTS)
    far = "import importlib as i\n\n\ndef test_half():\n    assert i.import_module('demheat.thing').unasked(4) == 2\n"
    (tree / "tests" / "far" / "test_far.py").write_text(far)
    (tmp_path / "list.csv").write_text(LIST)
    found, gone = breaks.listed(tmp_path / "list.csv", tree)
    assert [each.key() for each in found] == [("demheat/thing.py", "8", "a quarter", "n * 0.5", "n * 0.25")]
    assert [row["meaning"] for row in gone] == ["stands there often", "no such file"]
    near = breaks.stages(found[0].module, tree)
    assert breaks.stages(found[0].module, tree, rest=True) == [*near, ["tests/far/test_far.py"]]
    breaks.run(found, out, root=tree, rest=True)
    assert [row["by"] for row in breaks.rows(out)] == ["tests/far/test_far.py::test_half"]


def test_chosen_breaks_are_other_programs():
    found, gone = breaks.listed(breaks.ROOT / "tests" / "tools" / "chosen.csv")
    # Code moves on; a list of which a third is gone says little.
    assert len(found) > 2 * len(gone) and len(found) >= 45
    for module in {each.module for each in found}:
        text = (breaks.ROOT / module).read_text(encoding="utf-8")
        sound = ast.dump(ast.parse(text))
        for each in found:
            if each.module == module:
                assert ast.dump(ast.parse(each.mutant.apply(text))) != sound, each
