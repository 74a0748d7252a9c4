"""Only here: breaks that are the same program, or not those that a source has; a list that has fallen behind."""

import ast

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
