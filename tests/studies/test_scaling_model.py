"""Only here: ranks asked for more slabs than the engine makes; rows on two ranks where there is MPI."""

import pytest

from studies.scaling import model, ranks


def test_slabs_end_where_the_engine_refuses_them():
    from demheat.gallery import sphere_in_cube
    from demheat.mpi.slabs import slabs_of

    most = model.most_slabs(1e6)
    slabs_of(sphere_in_cube(5.0), 1_000_000, most, 0)
    with pytest.raises(ValueError, match=f"must be at most {most}$"):
        slabs_of(sphere_in_cube(5.0), 1_000_000, most + 1, 0)


@pytest.mark.slow
def test_a_row_on_two_ranks():
    if ranks.missing():
        pytest.skip(ranks.missing())
    row = ranks.row(1, 4000, 0, 2)
    assert row["unknowns"] > 4000 and row["residual"] <= 1e-10
    # Two exchanges of each cycle and one of each product go to the one neighbour, and those of the levels below.
    assert row["messages"] >= 3 * row["iterations"] and row["reductions"] >= 3 * row["iterations"]
    assert row["iterate_wall_s"] < row["solve_wall_s"] < row["wall_s"]
