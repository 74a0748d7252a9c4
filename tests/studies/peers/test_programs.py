"""Where a program has its walls, what it answers in a case of its own manual, what it refuses: skipped where it is not.

Of its rows the study knows the errors; a convention of half a voxel, taken for an error, would be seen here alone.
"""

from importlib import import_module

import pytest

from demheat import Layer, Material, Scene
from studies.peers import given

N = 8
QUARTER = Scene(given.SIZE, given.MATRIX, [Layer(0, 0.0, 0.25, Material(10.0))], walls=given.WALLS)
HALF = Scene(given.SIZE, given.MATRIX, [Layer(2, 0.0, 0.5, Material(0.0))], walls=given.WALLS)
ACROSS, LAYERS = given.scene("layers across"), 2 / (1 / 10 + 1)
OFF = "layers off the grid"
# Resistance of the quarter of 10 W/(m K) and the rest, in voxels; half a voxel of its first and its last material.
WHOLE, ENDS = 2 / 10 + 6, 0.5 / 10 + 0.5
# Program, body, knobs, conductivity, and how near solvers and digits leave it: walls on the faces of the body or, by
# the program's convention, in the centres of the first and last voxels or half a voxel outside.
KNOWN = [
    ("fipy", ACROSS, {"n": 8}, LAYERS, 1e-9),
    ("fipy", HALF, {"n": 4}, 0.5, 1e-9),
    ("mfem", ACROSS, {"n": 4, "order": 2}, LAYERS, 1e-9),
    ("mfem", HALF, {"n": 4}, 0.5, 1e-9),
    (
        "ngsolve",
        given.scene("layers off the grid"),
        {"size": 0.5, "order": 3},
        given.known("layers off the grid"),
        1e-9,
    ),
    ("ngsolve", given.scene("sphere 10"), {"size": 0.2, "order": 5}, given.known("sphere 10"), 1e-6),
    ("openfoam", ACROSS, {"n": 4}, LAYERS, 1e-9),
    # The middle one of five resistances in series is 1 / mean(k), not the mean of 1 / k.
    ("openfoam", ACROSS, {"n": 4, "scheme": "linear"}, 1 / (1 / LAYERS + (2 / 11 - 1.1 / 2) / 4), 1e-9),
    ("openfoam", given.scene("homogeneous"), {"size": 0.2}, 1.0, 1e-7),
    ("openimpala", given.scene("homogeneous"), {"n": N, "solver": "mlmg"}, 1.0, 1e-8),
    ("openimpala", QUARTER, {"n": N, "solver": "pcg"}, N / (WHOLE - ENDS), 1e-7),
    ("openpnm", QUARTER, {"n": N, "by": "boundary pores"}, N / WHOLE, 1e-8),
    ("openpnm", QUARTER, {"n": N, "by": "pores"}, (N - 1) / (WHOLE - ENDS), 1e-8),
    ("openpnm", HALF, {"n": 4}, 0.5, 1e-8),
    ("puma", QUARTER, {"n": N}, (N - 1) / (WHOLE - ENDS), 1e-6),
    ("taufactor", QUARTER, {"n": N}, (N + 1) / (WHOLE + ENDS), 1e-4),
    ("taufactor", HALF, {"n": N, "solver": "Solver"}, 0.5, 1e-5),
]


def of(name):
    return import_module(f"studies.peers.programs.{name}")


def there(name):
    if of(name).missing():
        pytest.skip(of(name).missing())
    return of(name)


@pytest.mark.parametrize(("name", "scene", "knobs", "known", "near"), KNOWN)
def test_a_body_that_is_known(name, scene, knobs, known, near):
    assert there(name).solve(scene, **knobs).conductivity == pytest.approx(known, rel=near)


# As many digits as are printed, or as the manual itself asks for.
@pytest.mark.parametrize(
    ("name", "near", "words"),
    [
        ("fipy", 1e-8, "mesh1D"),
        ("openimpala", 1e-8, "concepts"),
        ("openpnm", 1e-6, "500"),
        ("puma", 1e-9, "matSeriesInx"),
        ("taufactor", 1e-5, "slanted"),
    ],
)
def test_a_case_of_its_own_manual(name, near, words):
    found, documented, source = there(name).own()
    assert found == pytest.approx(documented, abs=near) and words in source


@pytest.mark.parametrize(
    ("name", "scene", "knobs", "error", "words"),
    [
        ("openfoam", "pore", {"n": 4}, NotImplementedError, "divides by zero"),
        ("openfoam", "sphere 10", {}, ValueError, "must be one of them"),
        ("openfoam", "sphere 10", {"n": 4, "scheme": "cubic"}, ValueError, "scheme = 'cubic'"),
        ("openfoam", "sphere 10", {"size": 0.2, "gradient": "none"}, ValueError, "gradient = 'none'"),
        ("openimpala", "layers across", {"n": N}, NotImplementedError, "one conducting phase"),
        ("openpnm", "layers across", {"n": N, "by": "tortuosity_fd"}, NotImplementedError, "one conducting phase"),
        ("puma", "dispersion 10", {"n": N, "by": "fe"}, NotImplementedError, "periodic"),
    ],
)
def test_what_it_cannot_do_is_refused_before_it_is_run(name, scene, knobs, error, words):
    with pytest.raises(error, match=words):
        of(name).solve(given.scene(scene), **knobs)


def test_ngsolve_is_told_parts_from_the_matrix_inwards():
    asked = of("ngsolve").asked_for(given.scene("coated"))
    assert [part["kind"] for part in asked["parts"]] == ["box", "sphere", "sphere"]
    assert asked["parts"][1]["radius"] == 0.4 > asked["parts"][2]["radius"]
    assert asked["parts"][2]["conductivity"] == 10.0 and asked["walls"] == {"x-": 1.0, "x+": 0.0}
    layer = of("ngsolve").asked_for(given.scene(OFF))["parts"][1]
    assert layer == {"kind": "layer", "axis": 0, "start": 0.0, "stop": given.OFF, "conductivity": 10.0}
