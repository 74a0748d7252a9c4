"""Ask every method every relation on every drawn scene, and write what was found to docs/invariances.md.

    PYTHONPATH=.:tests python tests/tools/invariances.py [--scenes N] [METHOD...]

measures these methods (all, if none is named) on the first N scenes, puts their rows into docs/invariances.csv, and
writes the page from all rows there. It takes an hour on one processor, most of it for unstructured meshes.
"""

import argparse
import subprocess
import sys
import warnings
from datetime import date
from pathlib import Path

import numpy as np
from changed_scenes import RELATIONS
from drawn_scenes import COUNT
from method_scenes import METHODS
from relations import Spread, applies, exact, first, limit, second, spread

from demheat.runtime.rows import RowFile

DOCS = Path(__file__).parents[2] / "docs"
ROWS, PAGE = DOCS / "invariances.csv", DOCS / "invariances.md"
FIELDS = [f"{part}_{statistic}" for part in Spread._fields for statistic in ("max", "median")]
COLUMNS = ("method", "relation", "scenes", *FIELDS, "commit", "when")
FILE = RowFile(ROWS, "rows of relations", needs=COLUMNS, key=("method", "relation"), last=COLUMNS)
WORDS = {
    "conductivity": "Mean flux: size of the difference over the size of the mean flux",
    "temperature": "Temperature at 60 random points: root mean square of the difference over the imposed span",
    "flux": "Flux at these points: root mean square of the difference over the mean flux",
}


def measured(name, count):
    """Rows of a method, one for each relation that it is asked for on any of the scenes."""
    found = {}
    for seed in range(count):
        for relation in RELATIONS:
            try:
                if applies(name, relation, seed):
                    found.setdefault(relation, []).append(spread(name, relation, seed))
            except RuntimeError as error:
                print(f"{name}, {relation}, scene {seed}: left out: {error}", flush=True)
        first.cache_clear()
        second.cache_clear()
        print(name, seed, flush=True)
    return [_row(name, relation, spreads) for relation, spreads in found.items()]


def _row(name, relation, spreads):
    parts = {part: [getattr(each, part) for each in spreads] for part in Spread._fields}
    found = {part: (max(values), float(np.median(values))) for part, values in parts.items()}
    statistics = dict(zip(FIELDS, (number for part in Spread._fields for number in found[part]), strict=True))
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=DOCS)
    made = {"commit": commit.stdout.strip(), "when": date.today().isoformat()}
    return {"method": name, "relation": relation, "scenes": len(spreads)} | statistics | made


def stored():
    """Rows of the file, {(method, relation): row}."""
    return FILE.read()


def add(rows):
    """Put rows of one method into the file, in the place of its older ones."""
    names = {row["method"] for row in rows}

    def changed(before):
        kept = {key: row for key, row in before.items() if key[0] not in names}
        kept |= {(row["method"], row["relation"]): row for row in rows}
        order = [(name, relation) for name in METHODS for relation in RELATIONS if (name, relation) in kept]
        return [kept[key] for key in order]

    FILE.change(changed)


def page(rows):
    """The page, from rows alone."""
    lines = [HEAD, "| relation | of a scene |", "|---|---|"]
    lines += [f"| `{name}` | {relation.words} |" for name, relation in RELATIONS.items()]
    lines += ["", TABLES]
    for part, words in WORDS.items():
        lines += ["", f"## {words}", "", *_table(rows, part)]
    commits = sorted({row["commit"] for row in rows.values()})
    lines += ["", f"Rows: `docs/invariances.csv`, of commits {', '.join(commits)}."]
    return "\n".join(lines) + "\n"


def _table(rows, part):
    yield "| method | scenes | " + " | ".join(RELATIONS) + " |"
    yield "|---|---|" + "---|" * len(RELATIONS)
    for name in METHODS:
        own = [rows.get((name, relation)) for relation in RELATIONS]
        if any(row and row[f"{part}_max"] != "nan" for row in own):
            scenes = max(int(row["scenes"]) for row in own if row)
            yield f"| {name} | {scenes} | " + " | ".join(_cell(row, part) for row in own) + " |"


def _cell(row, part):
    if row is None:
        return ""
    largest, middle = (float(row[f"{part}_{statistic}"]) for statistic in ("max", "median"))
    text = f"{largest:.0e} ({middle:.0e})".replace("e-0", "e-").replace("0e+00", "0")
    method, relation = METHODS[row["method"]], row["relation"]
    above = "**!** " if not largest <= limit(method, relation, part) else ""
    return above + (f"*{text}*" if exact(method, relation) else text)


HEAD = f"""# Invariances

Made by `tests/tools/invariances.py`; nothing here is typed by hand.

{COUNT} scenes are drawn by seed (`tests/drawn_scenes.py`): one sphere, several unequal ones each of its own material,
coated ones, layers, many of unequal sizes, in boxes of unlike sides, between walls or under a mean gradient, materials
a hundredth to a hundred times as conducting as the matrix. Each is changed in a way after which its solution is known
from that before (`tests/changed_scenes.py`), and solved again at the coarse resolution of `tests/test_methods.py`.
"""
TABLES = """Largest (and median) difference over the scenes. In *italics* where it must be rounding and the solver's
tolerance, because the method's elements go with the scene or it has none; elsewhere two packings, meshes or voxels of
one scene differ as far as each of them errs. `tests/test_relations.py` asserts the same limits on a part of the scenes;
what is above its limit here is marked **!**. The column of scenes is the number asked in the relation asked most often;
unstructured meshes and multipoles are asked fewer, and where a solver does not reach its tight tolerance (1e-11), and
says so, the scene is left out."""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="METHOD")
    parser.add_argument("--scenes", type=int, default=COUNT)
    arguments = parser.parse_args()
    warnings.simplefilter("error")
    # As in tests/test_relations.py.
    warnings.filterwarnings("ignore", ".*are thin for particles")
    for name in arguments.names or METHODS:
        add(measured(name, arguments.scenes))
    PAGE.write_text(page(stored()))


if __name__ == "__main__":
    sys.exit(main())
