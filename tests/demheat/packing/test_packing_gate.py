"""Only here: a public function that lets a packing changed by hand through to a kernel."""

import ast
from pathlib import Path

import numpy as np
import pytest

import demheat
from demheat.dem.calibration import cube_like
from demheat.dem.networks import network_of
from demheat.packing import Packing, domain, lsa, make_packing, neighbours, relax, statistics, walls
from demheat.packing.gate import check_packing
from demheat.packing.twins import conforming

ROOT = Path(__file__).parents[3]
STEEL = demheat.Material(33.0)
CELL = demheat.Scene((1.0, 1.0, 1.0), STEEL, gradient=(1.0, 0.0, 0.0))
NONE = np.zeros(9, dtype=np.int64), np.empty(0, dtype=np.int64)


def good(**changed):
    """Eight spheres, two apart along each axis."""
    sites = np.stack(np.meshgrid(*[[0.25, 0.75]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    return make_packing(sites, np.full(8, 0.22), (1.0, 1.0, 1.0), True, {})._replace(**changed)


def changed(field, at, value):
    array = np.array(getattr(good(), field))
    array[at] = value
    return good(**{field: array})


# How each public function is called with a packing; those of other modules are thin, or behind these.
CALLS = {
    "relax.settle": lambda p: relax.settle(p),
    "neighbours.neighbours": lambda p: neighbours.neighbours(p),
    "neighbours.contacts": lambda p: neighbours.contacts(p, gap=0.1),
    "domain.cut": lambda p: domain.cut(p),
    "domain.replicate": lambda p: domain.replicate(p, (1, 1, 2)),
    "domain.walled": lambda p: domain.walled(p),
    "walls.walls": lambda p: walls.walls(p),
    "walls.wall_distance": lambda p: walls.wall_distance(p, "x-"),
    "walls.wall_distances": lambda p: walls.wall_distances(p),
    "walls.outward": lambda p: walls.outward(p, "x-"),
    "walls.check_margin": lambda p: walls.check_margin(p, 1.0),
    "walls.bulk": lambda p: walls.bulk(p, 1.0),
    "twins.conforming.conform": lambda p: conforming.conform(p, CELL),
    "twins.conforming.conformed": lambda p: conforming.conformed(p, CELL),
    "gate.check_packing": lambda p: check_packing(p),
    "statistics.regions.packing_fraction": lambda p: statistics.packing_fraction(p),
    "statistics.correlations.radial_distribution": lambda p: statistics.radial_distribution(p, r_max=0.9),
    "statistics.correlations.two_point": lambda p: statistics.two_point(p, r_max=1.0, lines=2),
    "statistics.contacts.coordination": lambda p: statistics.coordination(p, *NONE),
    "statistics.contacts.backbone": lambda p: statistics.backbone(p, *NONE),
    "statistics.contacts.fabric": lambda p: statistics.fabric(p, *NONE),
    "statistics.contacts.directions": lambda p: statistics.directions(p, *NONE),
}
# Beyond this folder.
OTHERS = {
    "lsa.lsa": lambda p: lsa.lsa(start=p, phi=0.5),
    "solve": lambda p: demheat.solve(CELL, packing=p),
    "solve calibrated": lambda p: demheat.solve(CELL, packing=p, law="calibrated", gap=0.5),
    "evolve": lambda p: demheat.evolve(
        demheat.Scene((1, 1, 1), demheat.Material(1, 1, 1), initial=0.0), [1.0], packing=p
    ),
    "build.network_of": lambda p: network_of(CELL, p, demheat.Laguerre()),
    "calibration.cube_like": lambda p: cube_like(p),
}
# Of functions behind the gate, with the reason.
BEHIND = {
    "tile.choice_of": "of what is made to conform",
    "tile.places_of": "of what is made to conform",
    "statistics.regions.core_volume": "after check_margin",
    "statistics.regions.core_bounds": "after check_margin",
    "statistics.regions.inscribed_box": "after check_margin",
}
WRONG = {
    "no packing": ("p", "'p': must be a Packing"),
    "centre nan": (changed("centers", (3, 1), np.nan), r"centers\[3\] = .*must be finite"),
    "centre far": (changed("centers", (3, 1), 50.0), r"centers\[3\] = .*must be finite, in the box from 0 to"),
    "centre beyond": (changed("centers", (0, 0), -1e-6), r"centers\[0\]"),
    "radius nan": (changed("radii", 5, np.nan), r"radii\[5\] = nan: must be a finite length > 0"),
    "radius negative": (changed("radii", 5, -0.2), r"radii\[5\] = -0.2"),
    "radius whose volume is zero": (
        changed("radii", 5, 1e-300),
        r"radii\[5\] = 1e-300: must be .* from 1e-50 to 1e\+50",
    ),
    "radius whose volume is infinite": (changed("radii", 5, 1e300), r"radii\[5\] = 1e\+300: must be"),
    "size whose volume is zero": (good(size=np.full(3, 1e-300)), "size = .*three finite lengths > 0, from 1e-50"),
    "fewer radii": (good(radii=np.full(7, 0.2)), r"radii of shape \(7,\): must be \(8,\)"),
    "no centres": (good(centers=np.empty((0, 3)), radii=np.empty(0)), r"must be \(n, 3\), n > 0"),
    "lists": (good(radii=[0.2] * 8), "radii is a list: must be an array of float64"),
    "single precision": (good(radii=np.full(8, 0.2, dtype=np.float32)), "radii is an array of float32"),
    "masked": (good(radii=np.ma.masked_equal(np.full(8, 0.2), 0.2)), "radii is a masked array"),
    "size zero": (changed("size", 2, 0.0), "size = .*three finite lengths > 0"),
    "size a tuple": (good(size=(1.0, 1.0, 1.0)), "size is a tuple"),
    "periodic a flag": (good(periodic=True), r"periodic = True: must be a \(3,\) array of bool"),
    "periodic numbers": (good(periodic=np.ones(3)), "periodic = .*must be a bool or three bools"),
    "domain unknown": (good(domain="cube"), "domain = 'cube': must be one of box"),
    "round and periodic": (good(domain="sphere"), "domain = 'sphere' with size .* not periodic"),
    "no provenance": (good(provenance=None), "provenance = None: must be a dict"),
}
NO_PERIODS = np.zeros(3, dtype=bool)


@pytest.mark.parametrize("call", CALLS | OTHERS)
def test_every_public_function_asks_the_gate(call):
    name = "start" if call == "lsa.lsa" else "packing"
    for wrong, (packing, words) in WRONG.items():
        with pytest.raises(ValueError, match=words) as caught:
            (CALLS | OTHERS)[call](packing)
        assert str(caught.value).startswith(name), wrong


def test_the_list_of_functions_is_whole():
    """Of every module here, all public functions that take a packing."""
    found, folder = set(), ROOT / "demheat" / "packing"
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        if parts[-1].endswith("kernels"):
            continue
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef) and node.name[0] != "_" and node.args.args:
                if node.args.args[0].arg == "packing":
                    found.add(".".join((*parts, node.name)))
    assert len(found) > 20
    assert found == set(CALLS) | set(BEHIND)


def test_what_is_good_passes():
    check_packing(good())
    check_packing(good(periodic=NO_PERIODS))
    check_packing(good(periodic=NO_PERIODS, domain="sphere"))
    # Stretched and rounded: the far face is within.
    check_packing(changed("centers", (0, 0), 1.0 + 1e-12))


def test_beyond_the_round_wall():
    packing = good(periodic=NO_PERIODS, domain="cylinder-z")
    corner = np.array(packing.centers)
    corner[2] = 0.05, 0.05, 0.5
    with pytest.raises(ValueError, match=r"packing.centers\[2\] = .*in the cylinder-z"):
        check_packing(packing._replace(centers=corner))


def test_make_packing_makes_what_passes():
    rng = np.random.default_rng(0)
    for body, periodic in (("box", True), ("box", (True, False, True)), ("cylinder-x", (True, False, False))):
        points = rng.random((300, 3)) * [0.5, 0.1, 0.1] + [0.0, 0.45, 0.45]
        packing = make_packing(points, rng.random(300) + 0.1, (1, 1, 1), periodic, {}, domain=body)
        assert isinstance(packing, Packing)
        check_packing(packing)


@pytest.mark.parametrize("law", ["calibrated", "platonic"])
def test_centres_that_coincide_are_named(law):
    """Facets between cells do not need a distance; contacts do, and gave not-a-number."""
    packing = changed("centers", 3, good().centers[4])
    with pytest.raises(ValueError, match="packing.centers: 3 and 4 coincide"):
        demheat.solve(CELL, packing=packing, law=law, gap=0.3)


def test_loose_packings_are_named():
    loose = good(radii=np.full(8, 0.05))
    with pytest.warns(UserWarning, match="packing: its spheres fill 0.00419 of the body"):
        assert demheat.solve(CELL, packing=loose).conductivity == pytest.approx(33.0, rel=1e-9)  # to rounding


def test_a_given_packing_may_be_changed_later():
    packing, points = good(periodic=NO_PERIODS), np.random.default_rng(1).random((20, 3))
    scene = demheat.Scene((1.0, 1.0, 1.0), STEEL, walls={"x-": 0.0, "x+": 1.0})
    field, expected = (demheat.solve(scene, packing=p) for p in (packing, good(periodic=NO_PERIODS)))
    packing.centers[:] *= 0.1
    packing.radii[:] = np.nan
    packing.provenance["algorithm"] = "mine"
    np.testing.assert_array_equal(field.temperature_at(points), expected.temperature_at(points))
    assert "algorithm" not in field.stats["packing"]
