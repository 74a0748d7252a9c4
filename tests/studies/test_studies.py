"""Every study at quick size: its rows are computed, its claims hold, its page and figure are made.

Rows are computed in this process, without warm-up: numbers are judged here, costs are not.
"""

import functools
import gc

import pytest

from studies.__main__ import study_names
from studies.harness import methods, provenance, runner, store, table
from studies.harness.claims import COSTLY
from studies.harness.replay import absent
from studies.harness.tolerance import moved

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


def _explained(study, claim):
    return any(words in claim.sentence for words in getattr(study, "FAILS", {}))


# The rest are for `make test-slow`: `test_record.py` has some rows of each, and claims are judged on the stored ones.
SHORT = ("table1_platonic",)


# Coarse packings may not resolve every gap of a random dispersion; the claims judge what that costs.
@pytest.mark.filterwarnings(
    "ignore:.*do not fit into gaps:UserWarning",
    "ignore:gaps beside inclusions:UserWarning",
    "ignore:cracks .* are small:UserWarning",
)
@pytest.mark.parametrize(
    "name", [name if name in SHORT else pytest.param(name, marks=pytest.mark.slow) for name in NAMES]
)
def test_quick_rows_and_claims(name, folder):
    study = runner.load(name)
    path = runner.run_study(name, folder, quick=True, say=lambda line: None, compute=_here)
    rows = store.read_rows(path)
    assert len(rows) == sum(map(bool, map(study.QUICK, study.CASES)))
    lost = [f"{key}: {row['note']}" for key, row in rows.items() if row["status"] not in runner.KEPT]
    assert not lost, f"rows of {name} that failed: {'; '.join(lost)}"
    stored = store.read_rows(provenance.ROOT / "results" / f"{name}.csv")
    pairs = [(runner.find_case(study, key), stored[key], row) for key, row in rows.items() if not absent(row)]
    told = [str(each) for case, old, new in pairs for each in moved(name, study, case, old, new)]
    assert not told, f"results/{name}.csv holds what this code does not give (python -m studies accept): {told}"
    claims, page = table.render(study, path)
    # Claims on costs are not judged: nobody knows what the machine did besides. Some are known to fail.
    wrong = [c for c in claims if (c.failed and not _explained(study, c)) or c.why not in ("", COSTLY)]
    failed = [f"{c.sentence}: {c.value:.3g}, limit {c.limit}" for c in wrong]
    assert not failed, f"claims of {name} that do not hold, or are not judged: {'; '.join(failed)}"
    assert len(claims) > 1 and study.__doc__.splitlines()[0] in page
    assert path.with_suffix(".png").stat().st_size > 10_000  # an empty figure has a tenth of this


@pytest.mark.parametrize("name", NAMES)
def test_cases_are_sound(name):
    study = runner.load(name)
    quick = [case for case in study.CASES if study.QUICK(case)]
    assert 0 < len(quick) < len(study.CASES)
    assert all(provenance.module_of(study, method) for method in {case["method"] for case in study.CASES})
    keys = [store.case_key(case) for case in study.CASES]
    assert len({*keys}) == len(keys)
    assert all(runner.find_case(study, keys[k]) is study.CASES[k] for k in (0, -1))


def test_a_row_in_its_own_process():
    study = runner.load("fig14_single_inclusion")
    case = runner.find_case(study, "name=exact,scene=third,contrast=10.0,method=exact")
    row = runner.spawn_row("fig14_single_inclusion", study, case)
    # Rayleigh's method, McPhedran and McKenzie (1978), to the digits printed in studies/fig14_single_inclusion.
    assert row["status"] == "ok" and row["k_ratio"] == pytest.approx(1.395734838, abs=5e-10)
    assert row["wall_s"] > 0 and row["peak_by"] in ("VmHWM", "ru_maxrss")
