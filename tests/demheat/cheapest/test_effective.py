"""Only here: a way to an accuracy that does not get there, or is not the cheapest."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spared import slow_but

from demheat import Box, Ellipsoid, Layer, Material, Scene, Sphere, effective, gallery, orthotropic, recommend, solve
from demheat.cheapest import answers, cost_laws, ways
from demheat.cheapest.loads import loads_of
from demheat.cheapest.measures import measures
from demheat.tensor import conductivity_tensor
from references import exact, fft, multipole
from studies.common.drawn import scene_of

# Not the function of the same name.
CHOSEN = import_module("demheat.cheapest.effective")
CUBE = gallery.sphere_in_cube(10.0)
# Two unlike spheres askew in a periodic cell: no symmetry, a full tensor.
ASKEW = Scene(
    (1.0, 1.2, 0.9),
    Material(1.0),
    [Sphere((0.3, 0.3, 0.3), 0.22, Material(8.0)), Sphere((0.55, 0.62, 0.52), 0.15, Material(20.0))],
    gradient=(0.0, 1.0, 0.0),
)


def test_loads_are_as_few_as_axes_are_unlike():
    loads = loads_of(CUBE)
    assert (set(loads.parts), loads.alike, loads.diagonal) == ({0}, (0, 0, 0), True)
    assert loads.parts[0].volume == pytest.approx(CUBE.volume / 8, rel=1e-12)
    assert loads.saved == ("1 of 3 loads: axes alike", "1/8 of the body: mirror planes")


def test_a_body_without_symmetry_takes_three_loads_on_one_set_up():
    loads = loads_of(ASKEW)
    assert (set(loads.parts), loads.diagonal, loads.together, loads.saved) == ({0, 1, 2}, False, True, ())
    # Between walls nothing is beside the diagonal, symmetry or not.
    walled = Scene(ASKEW.size, ASKEW.matrix, ASKEW.inclusions, walls={"z-": 0.0, "z+": 1.0})
    assert loads_of(walled).diagonal and loads_of(walled).together


@pytest.mark.parametrize(
    "method", ["multipole", "fft", *(pytest.param(name, marks=pytest.mark.slow) for name in ("fem", "dem", "bracket"))]
)
def test_every_method_gets_there(method):
    right = exact.solve(CUBE).conductivity
    found = effective(CUBE, accuracy=1e-2, method=method)
    assert found.method == method
    assert found.accuracy <= 1e-2
    assert_allclose(np.diag(found.tensor), right, rtol=1e-2)
    assert np.all(np.diag(found.lower) <= right) and np.all(right <= np.diag(found.upper))
    # Nothing beside the diagonal, and certainly so.
    off = ~np.eye(3, dtype=bool)
    assert np.all(found.tensor[off] == 0) and np.all(found.upper[off] == 0)
    assert found.cost["cpu_s"] > 0 and found.how and found.saved


@pytest.mark.parametrize("method", slow_but({"fft"}, ["fft", "dem"]))
def test_the_whole_tensor_lies_in_its_intervals(method):
    right = conductivity_tensor(multipole.solve_axes(ASKEW))
    assert abs(right[0, 1]) > 5e-3 * right[0, 0]  # there is something beside the diagonal
    found = effective(ASKEW, accuracy=3e-2, method=method)
    # The mean of an entry and its mirror image is one number, and so is the wider of their intervals.
    for each in (found.tensor, found.lower, found.upper):
        assert_allclose(each, each.T, rtol=1e-12)
    assert np.all(found.lower <= right) and np.all(right <= found.upper)


def test_a_laminate_is_closed():
    layer = Layer(2, 0.2, 0.45, Material(5.0))
    found = effective(Scene((1.0, 2.0, 1.0), Material(1.0), [layer], gradient=(1.0, 1.0, 0.0)))
    assert found.method == "exact"
    assert_allclose(np.diag(found.tensor), [2.0, 2.0, 1 / (0.75 + 0.25 / 5)], rtol=1e-12)


def begin_with(monkeypatch, *found):
    """The laws expect these ways."""
    monkeypatch.setattr(CHOSEN, "ways", lambda *_: list(found))


def test_what_is_too_coarse_is_refined(monkeypatch):
    begin_with(monkeypatch, ways.Way("fft", {"voxels": 8}, cpu_s=1.0, bytes=1e6))
    found = effective(CUBE, accuracy=3e-3)
    assert found.cost["rounds"] > 1 and found.knobs["voxels"] > 8
    assert found.accuracy <= 3e-3
    with pytest.raises(
        RuntimeError, match="half of its interval is .* with voxels = .* narrower ones would need .* GiB"
    ):
        effective(CUBE, accuracy=1e-6, memory=1e5)


def test_elements_too_long_for_a_body_are_shortened(monkeypatch):
    """Twice; what fails then is given up, with what it said."""
    tried = []

    def answered(way, loads):
        tried.append(way.knobs["size"])
        if len(tried) < 3:
            raise RuntimeError("no coarser run to compare with")
        return answers.Answer(np.eye(3), np.zeros((3, 3)), "by hand")

    monkeypatch.setattr(CHOSEN, "answer", answered)
    found = effective(CUBE, accuracy=1e-2, method="fem")
    assert found.knobs["size"] == tried[2] < tried[1] < tried[0]
    # Numbers as anybody writes them, not NumPy's.
    assert type(ways._scaled(np.float64(2.0), 0.5, 1.0)) is float
    assert [told.startswith("fem: no coarser run to compare with; begins anew") for told in found.passed] == [True] * 2
    monkeypatch.setattr(CHOSEN, "answer", lambda way, loads: (_ for _ in ()).throw(RuntimeError("it folds")))
    with pytest.raises(RuntimeError, match="no method gets to accuracy = 0.01 here.*fem: it folds$"):
        effective(CUBE, accuracy=1e-2, method="fem")


def test_multipoles_are_asked_again_where_their_interval_is_too_wide(monkeypatch):
    asked = []

    def answered(way, loads):
        asked.append(way.knobs["accuracy"])
        return answers.Answer(np.eye(3), 4e-3 / 4 ** len(asked) * np.eye(3), "by hand")

    monkeypatch.setattr(CHOSEN, "answer", answered)
    assert effective(ASKEW, accuracy=5e-4, method="multipole").method == "multipole"
    assert asked == pytest.approx([5e-4, 1.25e-4])


def test_multipoles_are_asked_for_their_interval_at_once():
    """Beside a narrow gap it is wider than what the last changes tell."""
    scene = gallery.random_dispersion(12, fraction=0.25, gap=0.01, seed=3)
    found = effective(scene, accuracy=1e-3, method="multipole")
    assert found.cost["rounds"] == 1 and found.accuracy <= 1e-3


def test_a_way_that_turns_out_dear_gives_way(monkeypatch):
    """The laws expect little of voxels; after the first run they are dearer than elements."""
    first = ways.Way("fft", {"voxels": 8}, cpu_s=0.01, bytes=1e6)
    begin_with(monkeypatch, first, ways.Way("fem", {"size": CUBE.size[0] / 10}, cpu_s=0.05, bytes=1e6))
    assert ways.finer(first, loads_of(CUBE), 10.0, 1e12).cpu_s > 0.05
    found = effective(CUBE, accuracy=2e-4, memory=1e12)
    assert found.method == "fem"
    # What was begun is told, and what would have gone on.
    (told,) = found.passed
    assert told.startswith("fft: half of its interval") and ", fem 0.05" in told


@pytest.mark.parametrize(
    ("other", "more", "stays"), [(0.6, {}, True), (0.4, {}, False), (0.6, {"doubt": "large"}, False), (2.0, {}, True)]
)
def test_a_way_that_was_begun_is_left_for_half_of_its_cost(other, more, stays):
    """Laws are about twice off; not for what is in doubt."""
    begun, one = ways.Way("fft", {}, cpu_s=1.0, **more), ways.Way("fem", {}, cpu_s=other)
    assert CHOSEN._next([one, begun], begun) is (begun if stays else one)
    assert CHOSEN._next([one, begun], None) is min(begun, one, key=lambda each: each.rank)


def test_spheres_that_elements_refuse_are_told():
    """A ball that touches a wall leaves a cusp; no way that is refused at once is recommended."""
    ball = Sphere((0.5, 0.5, 0.2), 0.2, Material(10.0))
    lines = recommend(Scene((1, 1, 1), Material(1.0), [ball], walls={"z-": 0.0, "z+": 1.0}), 1e-2).why.splitlines()
    assert any(line.startswith("fem: no, sphere at") and "cusp" in line for line in lines)


def test_what_nobody_reaches_is_refused_with_reasons():
    core = Sphere((0.3, 0.3, 0.3), 0.1, Material(1.0))  # multipoles know no spheres in spheres
    with pytest.raises(
        RuntimeError, match=r"no method gets to accuracy = 0.001 here\. .*fem: needs .* GiB to begin with"
    ):
        effective(replace(ASKEW, inclusions=[*ASKEW.inclusions, core]), memory=1e3)
    with pytest.raises(RuntimeError, match="exact: no closed form"):
        effective(ASKEW, method="exact")
    assert effective(ASKEW, accuracy=5e-2, method=("exact", "fft")).method == "fft"


def test_recommendations_say_why():
    told = recommend(CUBE, 1e-3)
    assert told.method == "exact" == told.ways[0].method
    assert told.cpu_s == 0.0
    assert {"exact", "fem", "fft", "dem", "multipole"} == {way.method for way in told.ways}
    assert "1/8 of the body: mirror planes" in told.why
    # What costs least is named first, and what is refused last.
    costs = [way.cpu_s for way in recommend(ASKEW, 1e-3).ways if way.cpu_s == way.cpu_s and not way.refused]
    assert costs == sorted(costs)
    assert recommend(ASKEW, 1e-3).ways[-1].refused.startswith("no closed form")
    # What is expected not to fit is in doubt, what cannot even begin is none.
    assert "dem: in doubt, expected to need" in recommend(ASKEW, 1e-8, memory=1e9).why
    assert recommend(ASKEW, 1e-3, memory=1.0).method == ""


@pytest.mark.filterwarnings("ignore:gaps beside inclusions")
@pytest.mark.parametrize(("contrast", "rule"), [(10.0, "laminate"), (1000.0, "links"), (0.0, "plain")])
def test_the_fft_is_judged_by_the_rule_that_it_takes(contrast, rule):
    """Laminates, which it leaves at high contrast, would have needed 1800 CPU-s and 14 GB at contrast 1000."""
    scene = gallery.sphere_in_cube(contrast)
    # A third of the voxels that 1e-3 needs, and the same rules.
    told = {way.method: way for way in recommend(scene, 2e-3).ways}["fft"]
    part = measures(loads_of(scene).parts[0])
    law = {"laminate": "fft"}.get(rule, f"fft-{rule}")
    needed = cost_laws.needed_to_show(law, part, 2e-3)
    assert told.error == cost_laws.predicted(law, part, needed).error
    # The rule for pores is the same in few voxels.
    field = fft.solve(scene, voxels=told.knobs["voxels"] if contrast else 8)
    assert field.stats["rule"] == rule
    if contrast:  # what is said of pores is an upper end
        assert told.cpu_s < 2.0 and told.bytes < 2**26
        # 3.4e-4 was found of either.
        assert_allclose(field.conductivity, exact.solve(scene).conductivity, rtol=1e-3)


def test_an_ellipsoid_that_conducts_well_is_no_case_for_a_large_machine():
    """By laminates it was said to need 170 GiB and more; 60 voxels along the edge of an eighth do.

    Laws tell 69 CPU-s; one solve of the whole takes 16. The limit was 60 until they were fitted anew.
    """
    body = Ellipsoid((0.5, 0.5, 0.5), (0.4, 0.3, 0.25), Material(1000.0))
    told = {way.method: way for way in recommend(Scene((1.0,) * 3, Material(1.0), [body], gradient=(1, 0, 0))).ways}
    assert not told["fft"].doubt and told["fft"].bytes < 2**28 and told["fft"].cpu_s < 120


def test_what_costs_by_the_inclusion_is_not_made_coarser_without_end():
    """Linear and quadratic meshes pay for each sphere, whatever the edges: once a step coarser overflowed."""
    found = {way.method: way for way in recommend(scene_of("polydisperse", 2005), 1e-3).ways}
    assert found["fem"].cpu_s > ways.FIRST and 0 < found["fem"].knobs["size"] < 1.0


def test_equal_walls_are_refused_before_any_method_is_tried():
    level = replace(CUBE, walls={"y-": 5.0, "y+": 5.0})
    for ask in (effective, recommend):
        with pytest.raises(ValueError, match="Scene.walls = .*must differ in temperature"):
            ask(level)


@pytest.mark.filterwarnings("ignore:inclusions .* are smaller than a voxel")
def test_intervals_that_reach_to_one_side_are_held_whole():
    # Grids of even numbers miss the speck: what it may do is all above the answer.
    speck = Scene((1.0, 1.0, 1.0), Material(1.0), [Sphere((0.5, 0.5, 0.5), 0.019, Material(100.0))], gradient=(0, 1, 0))
    error = fft.solve(speck, voxels=24).error
    loads = loads_of(speck)
    found = answers.answer(ways.Way("fft", {"voxels": 24}), replace(loads, parts=loads.wholes))
    assert error.lower == pytest.approx(1.0, abs=1e-9) and error.upper > 1.0001
    assert np.all(np.diag(found.tensor + found.half) >= error.upper - 1e-12)


BALL = (0.5, 0.5, 0.45), 0.3
OTHERS = {
    "tensor": Scene((1, 1, 1), Material(1.0), [Sphere(*BALL, Material(orthotropic(2, 4, 9)))], gradient=(0, 1, 0)),
    "k(T)": Scene(
        (1, 1, 1),
        Material(1.0),
        [Sphere(*BALL, Material(4.0, dependence=[(0.0, 1.0), (9.0, 2.0)]))],
        walls={"y-": 0.0, "y+": 9.0},
    ),
    "infinite": Scene((1, 1, 1), Material(1.0), [Sphere(*BALL, Material(np.inf))], gradient=(0, 1, 0)),
    "resistance": Scene((1, 1, 1), Material(1.0), [Sphere(*BALL, Material(9.0), resistance=0.1)], gradient=(0, 1, 0)),
}


@pytest.mark.parametrize("name", OTHERS)
def test_what_few_methods_take(name):
    scene = OTHERS[name]
    told = {way.method: way.refused for way in recommend(scene, 2e-2).ways}
    assert (told["fft"] == "") == (name != "k(T)")
    assert (told["dem"] == "") == (name != "tensor")
    found = effective(scene, accuracy=2e-2, method=("fft", "dem"))
    assert found.accuracy <= 2e-2 and not found.cut
    by = {"k(T)": solve, "infinite": solve}.get(name, fft.solve)
    knobs = {"particles": 20_000} if by is solve else {"voxels": 48}
    right = by(scene, **knobs).conductivity
    # What is right is right to a few thousandths itself.
    assert found.lower[1, 1] * (1 - 2e-3) <= right <= found.upper[1, 1] * (1 + 2e-3)


def test_what_methods_take_is_what_they_refuse():
    """Each entry of `TAKES`, and each that is not there, is asked of the method itself."""
    for name, takes in ways.TAKES.items():
        for kind, scene in (("anisotropy", "tensor"), ("dependence", "k(T)"), ("perfect", "infinite")):
            if kind not in takes:
                with pytest.raises(NotImplementedError):
                    ways.HOMES[name].solve(OTHERS[scene])


def test_what_a_method_closes_in_on_is_taken_where_it_has_such_a_limit():
    box = Scene((1.0,) * 3, Material(1.0), [Box((0.5,) * 3, (0.4,) * 3, Material(5.0))], gradient=(1.0, 0.0, 0.0))
    close, plain = (effective(scene, accuracy=5e-2, method="fft") for scene in (CUBE, box))
    assert (close.how, plain.how) == ("larger voxels, extrapolated", "larger voxels")
    right = exact.solve(CUBE).conductivity
    field = fft.solve(loads_of(CUBE).parts[0], **close.knobs)
    assert close.tensor[0, 0] == pytest.approx(field.extrapolated.conductivity, rel=1e-9)
    assert abs(close.tensor[0, 0] - right) < abs(field.conductivity - right)
    # Of the DEM the interval about its own answer is narrower.
    assert effective(CUBE, accuracy=5e-2, method="dem").how == "fewer particles"


def test_coarser_runs_of_an_extrapolation_cost_less():
    def expected(scene, name):
        return next(way for way in ways.ways(loads_of(scene), 1e-3, 1e12) if way.method == name)

    found = expected(CUBE, "fem")
    law, part = ways._law("fem", loads_of(CUBE))
    assert found.cpu_s == pytest.approx(1.3 * cost_laws.predicted(law, part, found.knobs["size"]).cpu_s, rel=0.2)
    for name, law, yes in (
        ("fem", "fem", True),
        ("fft", "fft-links", True),
        ("fft", "fft-plain", False),
        ("dem", "dem", False),
    ):
        assert ways._has_limit(name, law, loads_of(CUBE)) is yes
