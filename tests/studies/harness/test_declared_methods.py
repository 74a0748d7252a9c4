"""What the harness makes of the methods that modules declare."""

import csv
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from demheat.method import PARTICLES, SIZE, VOXELS, Errors, Method, Resolution
from studies.harness import methods, pick, runner, store

RESULTS = sorted((Path(__file__).parents[3] / "results").glob("*.csv"))


def test_methods_come_in_one_order():
    """Fields, formulas, witnesses; families together, the default of each first: so tables and legends list them."""
    order = [method.module for method in methods.all_methods().values()]
    assert list(dict.fromkeys(order)) == ["dem", "fem", "fft", "bounds", "exact", "multipole"]
    assert [method.name for method in methods.compared()] == ["dem", "fem", "fft", "fft-em"]
    assert [method.name for method in methods.compared("fem-p1", "maxwell")][2] == "fem-p1"


def test_a_case_has_the_module_and_what_the_method_fixes():
    made = methods.case("fem-p1", contrast=2.0, size=0.1)
    assert list(made.items()) == [("name", "fem-p1"), ("contrast", 2.0), ("size", 0.1), ("method", "fem"),
                                  ("order", 1), ("curved", False)]  # fmt: skip


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_every_stored_row_is_found_by_a_case(path):
    csv.field_size_limit(10**9)
    with path.open(encoding="utf-8", newline="") as file:
        stored = {row["case"] for row in csv.DictReader(file)}
    assert stored and stored - {store.case_key(case) for case in runner.load(path.stem).CASES} == set()


def toy(**more):
    cells = Resolution("cells", lambda cells: 1 / cells, "{:.0f} cells")
    return Method(name="toy", title="toy", resolution=cells, coarse=20, module="toy", **more)


@pytest.fixture
def with_toy(monkeypatch):
    """One more method, of a knob that no study knows, and one that nothing refines."""
    closed = Method(name="closed", title="closed", module="closed")
    known = {**methods.all_methods(), "toy": toy(small=5), "closed": closed}
    monkeypatch.setattr(methods, "all_methods", lambda: known)


def test_what_a_study_spends(with_toy):
    spends = {"voxels": (64, 128), "size": (0.1,), "fem-p1": (0.05, 0.02)}
    found = methods.all_methods()
    values = {name: methods.spent(found[name], spends) for name in ("fft", "fem", "fem-p1", "dem", "toy", "closed")}
    assert values == {
        "fft": (64, 128), "fem": (0.1,), "fem-p1": (0.05, 0.02), "dem": (1000, 8000), "toy": (5, 20), "closed": (None,)
    }  # fmt: skip
    assert methods.at(found["dem"], 1000, seed=2) == {"particles": 1000, "seed": 2}
    assert methods.at(found["fem"], 0.5) == {"size": 0.5 * methods.EDGE}
    assert (methods.at(found["toy"], 5), methods.at(found["closed"], None)) == ({"cells": 5}, {})


def test_a_row_knows_its_resolution_by_its_methods_knob(with_toy):
    rows = [
        {"name": "dem", "particles": 8000},
        {"name": "fem", "size": 0.25 * methods.EDGE, "order": 2},
        {"name": "fft", "voxels": 64},
        {"name": "multipole", "order": math.nan, "degree": 8},
        {"name": "toy", "cells": 20, "voxels": None},
        {"name": "closed"},
        {"name": "none of them", "particles": 10},
    ]
    df = pd.DataFrame(rows)
    words = ["8000 particles", "h = 0.25 L", "64^3 voxels", "degree 8", "20 cells", "", ""]
    assert [methods.resolution(row) for _, row in df.iterrows()] == words
    sizes = [0.05, 0.25, 1 / 64, 1 / 8, 1 / 20, math.nan, math.nan]
    np.testing.assert_allclose(pick.with_size(df)["h"], sizes, rtol=1e-14)  # rounding
    more = pd.DataFrame([*rows, {"name": "toy", "cells": 40}, {"name": "toy", "cells": 40}])
    assert pick.finest(more[more["name"] == "toy"])["cells"].tolist() == [40, 40]
    assert len(pick.finest(df[df["name"] == "closed"])) == 1


def test_small_sizes():
    assert [PARTICLES.size(1000), SIZE.size(0.1), VOXELS.size(10)] == pytest.approx([0.1] * 3, rel=1e-14)
    assert methods.small("dem") == {"particles": 1000} and methods.small("fem") == {"size": methods.EDGE / 4}
    assert methods.small("exact") == {} and methods.small("no method") == {}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"exceptions": {"speed": "slow"}}, "exceptions of method 'toy'"),
        ({"refuses": {"cubes": "no"}}, "refuses of method 'toy'"),
        ({"role": "hero"}, "role of method 'toy'"),
        ({"coarse": None}, "coarse of method 'toy' = None"),
    ],
)
def test_what_is_no_property_is_refused(more, words):
    known = {"name": "toy", "title": "toy", "resolution": VOXELS, "coarse": 3, "errors": Errors(1.0)}
    with pytest.raises(ValueError, match=words):
        Method(**{**known, **more})
