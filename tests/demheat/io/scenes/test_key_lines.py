"""Only here: keys of a TOML text that have no line, or another."""

import pytest

from demheat.io.scenes.lines import lines_of
from demheat.io.scenes.source import tomllib

TEXTS = {
    "tables": (
        'a = 1\n\n[t]\nb.c = 2\n[t.u]\nd = 3\n[v."w x".y]\n',
        {("a",): 1, ("t", "b", "c"): 4, ("t", "u", "d"): 6},
    ),
    "arrays of tables": (
        "[[p]]\na = 1\n[[p.q]]\nb = 1\n[[p.q]]\nb = 2\n[p.r]\nc = 1\n[[p]]\na = 2\n[[p.q]]\nb = 3\n",
        {("p", 0): 1, ("p", 0, "q", 1, "b"): 6, ("p", 0, "r", "c"): 8, ("p", 1, "q", 0, "b"): 12},
    ),
    "inline": (
        "a = [1, # ]\n [2, 3],\n{b = 1, c = {d = '}'}},\n]\ne = {f = [\n1,\n2], g = 1}\n",
        {("a", 1, 1): 2, ("a", 2, "c", "d"): 3, ("e", "f", 1): 7, ("e", "g"): 7},
    ),
    "strings": (
        'a = """x\n"y" ] = 3\n"""\nb = \'\'\'\n[c]\n\'\'\'\n"d # e" = "f = \\" 1"\n\'g.h\' = 1\ni = \'\\\'\n',
        {("b",): 4, ("d # e",): 7, ("g.h",): 8, ("i",): 9},
    ),
    "quotes at the end": ('a = """""x"""""\nb = 1\n', {("b",): 2}),
    "escapes": ('"\\u0061\\t" = 1\n"\\"" = 2\n', {("a\t",): 1, ('"',): 2}),
    "scalars": ("a = 1979-05-27T07:32:00Z # t\nb = +inf\nc = 0x_ff\n".replace("0x_ff", "0xff"), {("c",): 3}),
    "line ends": ("a = 1\r\n\r\nb = 2\r\n", {("b",): 3}),
    "nothing": ("# only\n", {}),
    "no end": ("a = 1", {("a",): 1}),
}


def paths(value, path=()):
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in parts:
        yield (*path, key)
        yield from paths(part, (*path, key))


@pytest.mark.parametrize("name", TEXTS)
def test_every_key_has_its_line(name):
    text, lines = TEXTS[name]
    found = lines_of(text)
    assert set(found) == set(paths(tomllib.loads(text)))
    assert {path: found[path] for path in lines} == lines
