"""Stored rows made again: what the record holds, this code gives.

`replayed.csv` has the rows, `executed.txt` the files of the engine and the references that they execute; both are
written by `tests/tools/replayed.py`. The other quick rows are compared in `test_studies.py`, by `make test-slow`.
"""

import ast
import csv
import gc
from pathlib import Path

import pytest

from studies.__main__ import study_names
from studies.harness import provenance, runner, store
from studies.harness.replay import absent
from studies.harness.tolerance import moved

HERE = Path(__file__).parent
STORED = provenance.ROOT / "results"
with (HERE / "replayed.csv").open(newline="", encoding="utf-8") as file:
    COSTS = {(row["study"], row["case"]): float(row["cpu_s"]) for row in csv.DictReader(file)}
CHOSEN = list(COSTS)
# CPU-seconds from which a row is for `make test-slow`.
MOST = 2.0
EXECUTED = set((HERE / "executed.txt").read_text(encoding="utf-8").split())
# What a case says of the code that makes its row.
KINDS = ("name", "method", "law", "integrator", "scheme", "rule")
SAME = {"name": "method"}
# Files and folders of which no quick row is made, and why.
REFUSED = "says no, or ends what takes too long: tests of its own"
READ = "read, written or asked in a terminal: compared to the letter or the bit by tests of its own"
DRAWN = "drawn"
LARGE = "several processes or less memory: compared with the plain way by tests of its own"
BODIES = (
    "unions, tori, triangles and sets known by their inside alone are in no replayed row: beside others, by own tests"
)
NARROW = "asked in gaps so narrow that rows take seconds: by all degrees, in tests of its own"
FORMS = "no study asks for it: held against limits and other forms by tests of its own"
WALKS = "rows of walks take half a minute: held against exact values by tests of its own"
CROWDS = "asked where spheres are many or walls cut them, which quick rows do not mesh: tests of its own"
INLINED = "compiled into kernels that rows do execute, and called by nothing else"
SHIPPED = "made the tiles that are shipped: a test makes one again"
RENAMED = "an old name: a test asks for it"
CLAIMS = "claims extrapolate rows by it; no row does"
NO_ROWS = {
    "demheat/runtime/deadline.py": REFUSED,
    "demheat/scene/edges.py": REFUSED,
    "references/fem/cusps.py": REFUSED,
    "demheat/terminal/commands": READ,
    "demheat/io": READ,
    "demheat/grains/contact_files.py": READ,
    "demheat/terminal/ends.py": READ,
    "demheat/scene/told.py": READ,
    "demheat/terminal/pictures.py": DRAWN,
    "demheat/terminal/report": DRAWN,
    "references/mesh/export.py": DRAWN,
    "demheat/scene/beats.py": REFUSED,
    "demheat/renamed.py": RENAMED,
    "demheat/streamed.py": RENAMED,
    "demheat/mpi": LARGE,
    "demheat/beyond/petsc.py": LARGE,
    "demheat/beyond/ranks.py": LARGE,
    "demheat/sweeps": LARGE,
    "demheat/beyond/cluster.py": LARGE,
    "references/fem/ranks.py": LARGE,
    "references/fem/shares.py": LARGE,
    "references/fft/pencils.py": LARGE,
    "references/fft/ranks.py": LARGE,
    "references/fft/slabs.py": LARGE,
    "demheat/runtime/copies.py": LARGE,
    "demheat/runtime/fresh.py": LARGE,
    "demheat/runtime/rows.py": READ,
    # The mesher's own process, which no row of this one follows.
    "references/mesh/worker.py": LARGE,
    "demheat/scene/shapes/occ.py": LARGE,
    "references/mesh/size_kernels.py": LARGE,
    "demheat/conduction/perfect.py": FORMS,
    "demheat/scene/perfect.py": FORMS,
    "demheat/scene/shapes/traced.py": BODIES,
    "demheat/scene/shapes/creases.py": BODIES,
    "demheat/scene/shapes/parted.py": BODIES,
    "demheat/scene/shapes/torus.py": BODIES,
    "demheat/scene/shapes/closed.py": BODIES,
    "demheat/scene/shapes/patches.py": BODIES,
    "demheat/scene/shapes/surface_mesh.py": BODIES,
    "demheat/scene/shapes/triangles.py": BODIES,
    "demheat/scene/shapes/union.py": BODIES,
    "references/bracket/voxels/tensor.py": FORMS,
    "demheat/splitting.py": FORMS,
    "demheat/scene/boards.py": FORMS,
    "references/exact/inclined.py": FORMS,
    "references/multipole/at_rest.py": FORMS,
    "references/multipole/turns.py": NARROW,
    "references/multipole/lane_kernels.py": INLINED,
    "references/mesh/size_table.py": CROWDS,
    "references/mesh/turns.py": CROWDS,
    "references/richardson.py": CLAIMS,
    "references/walkers": WALKS,
    "demheat/packing/tile_recipe.py": SHIPPED,
}


# Coarse packings may not resolve every gap of a random dispersion.
@pytest.mark.filterwarnings("ignore:.*do not fit into gaps:UserWarning", "ignore:gaps beside inclusions:UserWarning")
@pytest.mark.parametrize(
    ("name", "key"),
    [pytest.param(*pair, marks=pytest.mark.slow) if COSTS[pair] >= MOST else pair for pair in CHOSEN],
    ids=lambda word: word[:60],
)
def test_a_stored_row_is_found_again(name, key):
    study = runner.load(name)
    case, rows = runner.find_case(study, key), store.read_rows(STORED / f"{name}.csv")
    assert key in rows, f"{name} {key}: no stored row; python -m studies run {name} --out results"
    row = runner.compute_row(study, case, warm=False)
    gc.collect()
    gc.freeze()
    if absent(row):
        pytest.skip(row["note"])
    assert list(map(str, moved(name, study, case, rows[key], row))) == []


def test_every_stored_study_is_listed():
    """What lists studies looks for a word in their files: one that it misses is in no table, and no test asks it."""
    assert {path.stem for path in STORED.glob("*.csv")} <= set(study_names())


def test_no_stored_row_is_missing():
    for name in study_names():
        stored = store.read_rows(STORED / f"{name}.csv")
        missing = [key for key in map(store.case_key, runner.load(name).CASES) if key not in stored]
        assert missing == [], f"{name}: python -m studies run {name} --out results"


def test_every_study_method_law_and_integrator_of_a_quick_row_is_replayed():
    wanted, chosen = set(), set()
    for name in study_names():
        study = runner.load(name)
        for case in filter(study.QUICK, study.CASES):
            # A method is the same in a column of names.
            kinds = {("study", name), *((SAME.get(kind, kind), str(case[kind])) for kind in KINDS if case.get(kind))}
            wanted |= kinds
            chosen |= kinds if (name, store.case_key(case)) in CHOSEN else set()
    lacking = ", ".join(sorted(f"{kind} {name}" for kind, name in wanted - chosen))
    assert not lacking, (
        f"no row is made again of {lacking}: tests/studies/replayed.csv wants a line of a quick row (study, case, "
        "cpu_s), or python tests/tools/replayed.py, which chooses all of them anew"
    )


def test_every_file_that_makes_numbers_is_executed():
    def works(path):
        return any(isinstance(node, ast.FunctionDef) for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))))

    files = [path for home in ("demheat", "references") for path in (provenance.ROOT / home).rglob("*.py")]
    names = {str(path.relative_to(provenance.ROOT)) for path in files if works(path)}
    spared = {name for name in names if any(name == one or name.startswith(f"{one}/") for one in NO_ROWS)}
    idle = ", ".join(sorted(names - spared - EXECUTED))
    assert not idle, f"no replayed row executes {idle}: NO_ROWS wants the reason, or python tests/tools/replayed.py"
    # No reason is idle.
    assert [one for one in NO_ROWS if not any(name == one or name.startswith(f"{one}/") for name in names)] == []
    assert [name for name in EXECUTED if not (provenance.ROOT / name).exists()] == []
