"""Every study at quick size: its rows are computed, its claims hold, its page and figure are made.

Rows are computed in this process, without warm-up: numbers are judged here, costs are not.
"""

import functools
import gc

import pytest

from studies.__main__ import study_names
from studies.harness import methods, provenance, runner, store, table
from studies.harness.claims import COSTLY

NAMES = study_names()


def _here(name, study, case):
    row = runner.compute_row(study, case, warm=False)
    # As at the start of each module of tests: with what a row has loaded, a search costs more than most rows.
    gc.collect()
    gc.freeze()
    return row


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder of results; packings and transforms' plans are kept in one of this module's own, and what is exact."""
    with pytest.MonkeyPatch.context() as patch:
        # Half a second for each of many rows, of a few scenes.
        patch.setattr(methods, "exact_ratio", functools.cache(methods.exact_ratio))
        patch.setenv("DEMHEAT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield tmp_path_factory.mktemp("out")


def test_the_studies_are_there():
    assert {"fig14_single_inclusion", "surfaces", "speed_error", "stability"} <= set(NAMES)
    assert {"fig03_calibration", "packings"} <= set(NAMES)


# Their quick rows take 8 to 52 CPU-seconds each, together more than a third of all tests: `make test-slow`.
SLOW = (
    "anisotropy",
    "brackets",
    "ct_search",
    "damage",
    "estimates",
    "fig07_sphere",
    "fig08_sphere_field",
    "fig10_beam",
    "fig12_15_sheet",
    "fig15_16_fields",
    "fig17_etc",
    "fig18_fields",
    "grains",
    "hard_cases",
    "images",
    "kirchhoff",
    "many_inclusions",
    "nafems",
    "packings",
    "peers",
    "resistance",
    "scaling",
    "shapes",
    "speed_error",
    "sphere_benchmark",
    "stability",
    "time_integrators",
    "tuning",
    "zeta2",
)


# Coarse packings may not resolve every gap of a random dispersion; the claims judge what that costs.
@pytest.mark.filterwarnings("ignore:.*do not fit into gaps:UserWarning", "ignore:gaps beside inclusions:UserWarning")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in NAMES]
)
def test_quick_rows_and_claims(name, folder):
    study = runner.load(name)
    path = runner.run_study(name, folder, quick=True, say=lambda line: None, compute=_here)
    rows = store.read_rows(path)
    assert len(rows) == sum(map(bool, map(study.QUICK, study.CASES)))
    assert {key: row["note"] for key, row in rows.items() if row["status"] not in runner.KEPT} == {}
    claims, page = table.render(study, path)
    # Claims on costs are not judged: nobody knows what the machine did besides.
    assert [claim for claim in claims if claim.failed or claim.why not in ("", COSTLY)] == []
    assert len(claims) > 2 and study.__doc__.splitlines()[0] in page
    assert path.with_suffix(".png").stat().st_size > 10_000  # an empty figure has a tenth of this


@pytest.mark.parametrize("name", NAMES)
def test_cases_are_sound(name):
    study = runner.load(name)
    quick = [case for case in study.CASES if study.QUICK(case)]
    assert 0 < len(quick) < len(study.CASES)
    assert isinstance(study.PAPER, dict)
    for case in study.CASES:
        assert provenance.module_of(study, case["method"]), case
        assert runner.find_case(study, store.case_key(case)) is case


@pytest.mark.parametrize("name", NAMES)
def test_a_new_drawing_repeats_no_row(name, monkeypatch):
    """Neither what draws, judges nor keeps rows is part of a row's code; what looks at its fields is."""
    study, parse, seen = runner.load(name), provenance._parse, set()
    monkeypatch.setattr(provenance, "_parse", lambda path: seen.add(path.relative_to(provenance.ROOT)) or parse(path))
    provenance.code_hash.cache_clear()
    for method in sorted({case["method"] for case in study.CASES}):
        provenance.code_hash(study.__file__, provenance.module_of(study, method))
    provenance.code_hash.cache_clear()
    names = {path.stem for path in seen}
    # Tables of files are others.
    ours = {path.stem for path in seen if path.parts[0] == "studies"}
    assert not ours & {"figures", "figure", "sphere_looks", "tables", "table", "pick"}
    # Nor what keeps the books of rows.
    harness = {path.stem for path in seen if path.parts[:2] == ("studies", "harness")}
    assert harness <= {"__init__", "cells", "cost", "methods", "printed", "threads"}
    assert name != "fig15_16_fields" or {"field_errors", "slices", "halo"} <= names


def test_code_of_a_row_is_that_of_its_method(monkeypatch):
    study = runner.load("fig14_single_inclusion")
    codes = {
        method: provenance.code_hash(study.__file__, methods.path_of(method))
        for method in ("dem", "fem", "fft", "bounds")
    }
    assert len(set(codes.values())) == len(codes)
    parse = provenance._parse

    @functools.cache
    def changed(path):
        return parse(path) if path.name != "laguerre_kernels.py" else parse(provenance.ROOT / "studies/harness/cost.py")

    monkeypatch.setattr(provenance, "_parse", changed)
    provenance.code_hash.cache_clear()
    after = {method: provenance.code_hash(study.__file__, methods.path_of(method)) for method in codes}
    provenance.code_hash.cache_clear()
    assert {method for method in codes if after[method] != codes[method]} == {"dem"}


@pytest.mark.parametrize(
    "name", ["fig07_sphere", "fig14_single_inclusion", "fig17_etc", "fig18_fields", "many_inclusions"]
)
def test_rows_do_not_change_with_the_papers_network(name, monkeypatch):
    study, parse = runner.load(name), provenance._parse
    named = {case["method"] for case in study.CASES}

    def codes():
        provenance.code_hash.cache_clear()
        return {method: provenance.code_hash(study.__file__, provenance.module_of(study, method)) for method in named}

    @functools.cache
    def changed(path):
        return parse(path) if path.name != "paper_network.py" else parse(provenance.ROOT / "studies/harness/cost.py")

    before = codes()
    monkeypatch.setattr(provenance, "_parse", changed)
    after = codes()
    provenance.code_hash.cache_clear()
    assert {method for method in named if before[method] != after[method]} == {"network"}


def test_a_row_in_its_own_process():
    study = runner.load("fig14_single_inclusion")
    case = runner.find_case(study, "name=exact,scene=third,contrast=10.0,method=exact")
    row = runner.spawn_row("fig14_single_inclusion", study, case)
    # Rayleigh's method, McPhedran and McKenzie (1978), to the digits printed in studies/fig14_single_inclusion.
    assert row["status"] == "ok" and row["k_ratio"] == pytest.approx(1.395734838, abs=5e-10)
    assert row["wall_s"] > 0 and row["peak_by"] in ("VmHWM", "ru_maxrss")
