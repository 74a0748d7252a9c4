"""Strong and weak scaling on ranks: the model of rows that are made up of it, and rows where there is no MPI."""

import math

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

from studies import scaling
from studies.scaling import model, ranks

FIT = model.Fit(
    **{"twins": 2e-6, "packing": 3e-7, "cells": 1e-5, "setup": 8e-6, "share": 0.4, "field": 5e-7, "triad": 5e9},
    **{"iterations": 20.0, "growth": 1.0, "messages": 40.0, "rim": 30.0, "sums": 4.0, "crowd": 12.0},
    **{"held": 650.0, "base": 2e8},
)


def made_up(fit=FIT):
    """Rows of the full cases that cost what the model says."""
    rows = []
    for case in scaling.CASES:
        if case["part"] in ("strong", "weak"):
            unknowns = 1.02 * case["particles"]
            blocks = model.slabs(unknowns, case["ranks"], case["number"])
            row = case | {"status": "ok", "note": "", "unknowns": unknowns, "triad_rank_gbs": fit.triad / 1e9}
            row["twins"] = fit.crowd * case["number"] ** (1 / 3) * unknowns ** (2 / 3)
            row["iterations"] = fit.iterations + fit.growth * math.log10(unknowns / 1e6)
            found = model.of_row(fit, row)
            row |= {f"{stage}_wall_s": found[stage] for stage in ("packing", "cells", "iterate", "field")}
            row |= {"solve_wall_s": found["setup"] + found["iterate"], "wall_s": found["all"]}
            row |= {f"{stage}_cpu_s": row[f"{stage}_wall_s"] for stage in ("packing", "cells", "solve", "field")}
            row |= {"cpu_s": found["all"], "peak_mib": fit.held * blocks.seen * case["ranks"] / 2**20}
            row |= {"base_mib": fit.base * case["ranks"] / 2**20, "k_body": 2.0}
            row |= {"messages": fit.messages * row["iterations"] * blocks.neighbours}
            row |= {"message_bytes": fit.rim * row["iterations"] * blocks.cut, "reductions": 4 * row["iterations"]}
            rows.append(row)
    # Columns of other parts.
    return pd.DataFrame(rows).assign(kind=np.nan, fraction=np.nan, k_ratio=np.nan)


def test_constants_of_rows_that_are_made_of_them():
    rows = model.rows_of(made_up())
    assert len(rows) == 6 and rows["unknowns"].min() > 4e5
    assert_allclose(model.fitted(rows), FIT, rtol=1e-6)  # rounding of least squares
    assert_allclose(model.left_out(rows), 0.0, atol=1e-4)


def test_blocks():
    blocks = model.bricks(64_000.0, 64)
    assert sorted(blocks.counts) == [4, 4, 4] and blocks.neighbours == 26
    assert_allclose([blocks.own, blocks.edges[0]], [1000.0, 10.0])
    # Three of four blocks have a neighbour at either end of an axis.
    assert_allclose(blocks.seen, (10.0 + 1.5 * model.LAYER) ** 3)
    assert_allclose(blocks.cut, 3 * 1.5 * 100.0)
    two = model.slabs(2000.0, 2, number=2)
    assert_allclose(two.edges, [10.0] * 3)
    assert two.neighbours == 1
    assert_allclose([two.cut, two.seen], [100.0, 100.0 * (10.0 + model.LAYER)])
    assert sorted(model.bricks(1e9, 1024).counts) == [8, 8, 16]


def test_slabs_end_where_the_engine_refuses_them():
    from demheat.gallery import sphere_in_cube
    from demheat.mpi.slabs import slabs_of

    most = model.most_slabs(1e6)
    slabs_of(sphere_in_cube(5.0), 1_000_000, most, 0)
    with pytest.raises(ValueError, match=f"must be at most {most}$"):
        slabs_of(sphere_in_cube(5.0), 1_000_000, most + 1, 0)


def test_what_is_planned():
    plans = model.plans(model.rows_of(made_up()))
    shapes = {(plan["unknowns"], plan["cores"], plan["shape"]) for plan in plans}
    thin = {(n, 64, "slabs") for n in model.SIZES}
    assert shapes == thin | {(n, p, "bricks") for n in model.SIZES for p in model.CORES}
    (plan,) = (plan for plan in plans if (plan["unknowns"], plan["cores"], plan["shape"]) == (1e9, 1024, "bricks"))
    # By hand: 23 iterations of a million unknowns or so at .4 of 5 GB/s.
    assert_allclose(plan["iterations"], 23.0)
    work = 23.0 * model.MOVED * 1e9 / 1024 / 2e9
    cut = 2 * 15 / 16 * 125**2 + 2 * 2 * 7 / 8 * 125 * 62.5  # 16 blocks of 62.5 spacings, and 8 of 125 twice
    sent = 23.0 * (40 * 26 * 2e-6 + 30.0 * cut * 64 / 25e9)
    assert_allclose(plan["messages"], sent)
    assert_allclose(plan["sums"], 23.0 * 4 * 10 * 2e-6)
    assert_allclose(plan["iterate"], work + sent + plan["sums"])
    # Every rank makes all twins, so more cores do not help there.
    assert_allclose(plan["twins"], 2e-6 * 12.0 * 1e6)
    assert plan["packing"] > plan["twins"]


def test_a_row_of_spheres():
    from studies.scaling.on_ranks import bar

    scene = bar(3)
    assert_allclose(scene.size, np.array([3.0, 1.0, 1.0]) * bar(1).size)
    assert_allclose(np.diff([sphere.center[0] for sphere in scene.inclusions]), bar(1).size[0])
    assert set(scene.walls) == {"y-", "y+"}


@pytest.mark.slow
def test_a_row_on_two_ranks():
    if ranks.missing():
        pytest.skip(ranks.missing())
    row = ranks.row(1, 4000, 0, 2)
    assert row["unknowns"] > 4000 and row["residual"] <= 1e-10
    # Two exchanges of each cycle and one of each product go to the one neighbour, and those of the levels below.
    assert row["messages"] >= 3 * row["iterations"] and row["reductions"] >= 3 * row["iterations"]
    assert row["iterate_wall_s"] < row["solve_wall_s"] < row["wall_s"]
