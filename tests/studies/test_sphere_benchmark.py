"""A method that is not ours on the scenes of the benchmark: as a module, a number, a program; its rows and refusals."""

import json
import re
import sys
from pathlib import Path

import pytest

import benchmark
from studies.__main__ import main
from studies.harness import runner, store, table
from studies.sphere_benchmark import GUEST, guest_case, guests, rows, ways

STUDY = runner.load("sphere_benchmark")
ROOT = Path(__file__).parents[2]
DIFFERENCES, MAXWELL = "examples.own_method.finite_differences", "examples/own_method/maxwell"


def _here(name, study, case):
    return runner.compute_row(study, case, warm=False)


def _module(tmp_path, monkeypatch, name, text):
    (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    sys.modules.pop(name, None)
    return name


def _program(tmp_path, text):
    path = tmp_path / "program"
    path.write_text(f"#!{sys.executable}\n{text}", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize(
    "method, scene, limit",
    [
        # Voxels of a sixteenth: stairs err by per cents, and not at all where layers end at their faces.
        *(
            (DIFFERENCES, "sc-third-s10", 2.0),
            (DIFFERENCES, "laminate-across", 1e-6),
        ),
        (MAXWELL, "sc-third-s10-r0.9", 1e-10),
    ],
)
def test_the_examples_are_asked(method, scene, limit):
    assert abs(rows.solved(scene, ways.guest(method, 0))["error_percent"]) < limit


@pytest.mark.parametrize(
    "method, scene, told",
    [
        (DIFFERENCES, "sc-third-s10-r0.1", "resistance"),
        (DIFFERENCES, "nafems-t4", "conductivity alone"),
        (DIFFERENCES, "slab-step", "no evolve"),
        (MAXWELL, "ball-step", "conductivities alone"),
    ],
)
def test_the_examples_refuse(method, scene, told):
    with pytest.raises(NotImplementedError, match=told):
        rows.solved(scene, ways.guest(method, 0))


def test_a_module_with_fields_is_judged_by_them():
    """Our own exact solutions come as a guest would: conductivity, temperatures and fluxes are right to their error."""
    way = ways.guest("references.exact", 0)
    for scene in ("fibres-square-f50-s10", "laminate-resisting", "slab-heated", "ball-step"):
        row = rows.solved(scene, way)
        found = [row[name] for name in ("error_percent", "temperature_percent", "flux_percent") if name in row]
        assert len(found) == (3 if row["known"] else 2) and max(map(abs, found)) < 1e-6


def test_errors_at_points_are_in_parts_of_the_span_and_of_the_mean_flux(tmp_path, monkeypatch):
    """A linear temperature in a laminate of contrast 10: worked out here by hand."""
    name = _module(tmp_path, monkeypatch, "linear_guess", LINEAR)
    row = rows.solved("laminate-across", ways.guest(name, 0))
    known = benchmark.load("laminate-across")[1]
    off = 1 - known.positions[:, 0] - known.temperature
    assert row["error_percent"] == pytest.approx(100 * (2 / known.conductivity - 1))
    assert row["temperature_percent"] == pytest.approx(100 * (off**2).mean() ** 0.5)
    assert row["flux_percent"] == pytest.approx(100 * (2 / known.conductivity - 1))


LINEAR = """
import numpy as np

KNOBS = [{"guess": 2.0}, {"guess": 3.0}]

class Guess:
    def __init__(self, value):
        self.conductivity = value
    def temperature_at(self, points):
        return 1.0 - np.asarray(points)[:, 0]
    def flux_at(self, points):
        return np.tile([self.conductivity, 0.0, 0.0], (len(points), 1))

def solve(scene, guess=1.0):
    return Guess(guess)
"""


def test_a_module_that_fails_everywhere_says_why_and_has_its_table(tmp_path, monkeypatch):
    """Of each row its own reason, not that of the scene on which it is warmed up; no row has anything that is known."""
    text = "def solve(scene):\n    raise ValueError(f'{len(scene.inclusions)} of {type(scene.inclusions[0]).__name__}')"
    name = _module(tmp_path, monkeypatch, "fails_everywhere", text)
    cases = [case for case in guests(name, quick=True) if case["scene"] != "slab-step"]
    made = {row["case"]: row for row in (runner.compute_row(STUDY, case) for case in cases)}
    notes = {row["scene"]: row["note"] for row in made.values()}
    # Warmed up on two layers.
    assert (
        notes["sc-third-s10"] == "ValueError in solve: 1 of Sphere"
        and notes["relation scaled"] == "ValueError in solve: 12 of Sphere"
    )
    store.add_rows(tmp_path / "sphere_benchmark.csv", made, list(made))
    claims, page = table.render(STUDY, tmp_path / "sphere_benchmark.csv")
    # The file's value, as rows that failed have none; and each of the page's parts could be made.
    assert re.search(r"\| sc-third-s10 +\| 1.3957348 +\| .* ! +\|", page)
    assert [claim.sentence for claim in claims if claim.ok is False] == ["Rows that failed or ran out of time"]


def test_a_program_is_not_told_what_is_known_and_may_fail(tmp_path):
    told = tmp_path / "told"
    text = f"import shutil, sys; shutil.copy(sys.argv[1], {str(told)!r}); print('some words'); print(1.5)"
    row = rows.solved("sc-third-s10", ways.guest(_program(tmp_path, text), 0))
    assert row["conductivity"] == 1.5 and row["peak_mib"] > 1
    given = json.loads(told.read_text(encoding="utf-8"))
    assert "known" not in given and given["scene"] == benchmark.read("sc-third-s10")["scene"]
    for text, error, words in (
        ("print('no number')", ValueError, "must be a finite number"),
        ("print(float('nan'))", ValueError, "must be a finite number"),
        ("pass", ValueError, "must be a finite number"),
        ("import sys; sys.exit('out of luck')", RuntimeError, "exit status 1: out of luck"),
    ):
        with pytest.raises(error, match=words):
            rows.solved("sc-third-s10", ways.guest(_program(tmp_path, text), 0))


@pytest.mark.parametrize(
    "method", ["no_such.module", "./no_such_program", "examples/own_method/finite_differences.py", "json"]
)
def test_what_is_no_method_is_refused_at_once(method, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(ROOT)
    assert main(["run", "sphere_benchmark", "--method", method, "--out", str(tmp_path / "out")]) == 2
    assert f"method = {method!r}: must be a module that Python finds" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_what_a_module_lacks_itself_is_its_own_error(tmp_path, monkeypatch):
    name = _module(tmp_path, monkeypatch, "needs_more", "import no_such_library_at_all")
    with pytest.raises(ModuleNotFoundError, match="no_such_library_at_all"):
        guests(name)


def test_relations_are_seen_to_be_broken(tmp_path, monkeypatch):
    """A guess of 2 W/(m K), whatever the body: seven times the conductivities should give seven times as much."""
    way = ways.guest(_module(tmp_path, monkeypatch, "linear_guess", LINEAR), 0)
    found = {name: rows.related(name, way)["error_percent"] for name in ("uniform", "scaled", "reversed", "turned")}
    assert found == pytest.approx({"uniform": 100.0, "scaled": 100 * (1 / 7 - 1), "reversed": 0.0, "turned": 0.0})


def test_relations_change_what_they_say():
    seen = []

    def way(given):
        seen.append(given["scene"])
        return ways.Answer(1.0)

    for relation in ("scaled", "reversed", "turned", "tenfold"):
        rows.related(relation, way)
    scaled, base, reverse, _, turned, _, tenfold, _ = seen
    sphere = base["inclusions"][0]
    x, y, z = sphere["center"]
    assert [each["conductivity"] for each in scaled["materials"]] == [7.0, 70.0]
    assert [load["temperature"] for load in reverse["walls"].values()] == [0.0, 1.0]
    assert turned["inclusions"][0]["center"] == [z, x, y] and set(turned["walls"]) == {"y-", "y+"}
    assert tenfold["inclusions"][0]["radius"] == 10 * sphere["radius"] and tenfold["size"] == [10.0, 10.0, 10.0]


def test_rows_of_a_guest_stay_when_it_is_gone(tmp_path, monkeypatch):
    name = _module(tmp_path, monkeypatch, "linear_guess", LINEAR)
    out, quick = tmp_path / "out", {"quick": True, "say": lambda line: None, "compute": _here}
    path = runner.run_study("sphere_benchmark", out, method=name, **quick)
    mine = {key: row for key, row in store.read_rows(path).items() if row["method"] == GUEST}
    assert len(mine) == len(store.read_rows(path)) == len(guests(name, quick=True)) == 8
    assert {row["status"] for row in mine.values()} == {"ok", "unsupported"}
    assert all(guest_case(key) == runner.find_case(STUDY, key) for key in mine)
    (tmp_path / "linear_guess.py").unlink()
    del sys.modules["linear_guess"]
    # Another run, by another guest, and by ours: its rows are still there, in the table and in the figure.
    monkeypatch.setattr(STUDY, "QUICK", lambda case: case["name"] == "maxwell" and case["scene"] == "sc-third-s10")
    runner.run_study("sphere_benchmark", out, **quick)
    monkeypatch.chdir(ROOT)
    runner.run_study("sphere_benchmark", out, method=MAXWELL, **quick)
    stored = store.read_rows(path)
    assert set(mine) < set(stored) and {row["name"] for row in stored.values()} == {name, "maxwell", MAXWELL}
    claims, page = table.render(STUDY, path)
    assert "| linear_guess" in page and "cases and" in page and path.with_suffix(".png").stat().st_size > 10_000
    assert not any(claim.ok is False and "can be" in claim.sentence for claim in claims)
