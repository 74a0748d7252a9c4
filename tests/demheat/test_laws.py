"""Only here: laws that are not their short forms, choices without effect, networks other than k S / d by hand."""

import dataclasses
import re

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import demheat
from demheat import Calibrated, Laguerre, Material, Platonic, Scene, Sphere
from demheat.dem.networks import network_of
from demheat.laws import POLICIES, RULES, WALL_RULES, Choices
from demheat.network.base import branches, link_distances, row_numbers
from demheat.packing.cache import relaxed
from demheat.packing.neighbours import contacts

METAL, TEN = Material(2.0, density=3.0, heat_capacity=5.0), Material(20.0, density=3.0, heat_capacity=5.0)
BALL = Sphere((0.5, 0.5, 0.5), 0.3, TEN)
WALLED = Scene((1, 1, 1), METAL, [BALL], walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
CELL = Scene((1, 1, 1), METAL, [BALL], gradient=(0.0, 1.0, 0.0))
BLOCK = Scene((1, 1, 1), METAL, walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
SPHERE = Scene((1, 1, 1), METAL, domain="sphere", walls={"round": 1.0}, initial=0.0)
DRUM = Scene((1, 1, 1), METAL, domain="cylinder-y", walls={"round": 1.0}, initial=0.0)

# What asks nothing of any law.
UNASKED = {"sparse": "nearest", "wall": "center", "coordination": None, "gap": None}
SHORT = [
    (Laguerre(), {}),
    (Laguerre(), {"law": "laguerre", "conforming": True, "interface": "harmonic", **UNASKED}),
    (Laguerre(conforming=False, interface="arithmetic"), {"conforming": False, "interface": "arithmetic"}),
    (Calibrated(), {"law": "calibrated", "conforming": False, **UNASKED}),
    (Calibrated(coordination=6.5, sparse="drop"), {"law": "calibrated", "coordination": 6.5, "sparse": "drop"}),
    (Calibrated(gap=0.1, wall="surface"), {"law": "calibrated", "gap": 0.1, "wall": "surface"}),
    (Platonic(coordination=6.2, wall="surface"), {"law": "platonic", "coordination": 6.2, "wall": "surface"}),
]


def assert_same_field(one, two):
    assert_array_equal(one.mean_flux, two.mean_flux)
    for ours, theirs in zip(one.samples, two.samples, strict=True):
        assert_array_equal(ours, theirs)
    assert one.stats["law"] == two.stats["law"] and one.stats["calibration"] == two.stats["calibration"]


@pytest.mark.parametrize(("law", "short"), SHORT)
def test_objects_are_their_short_forms_to_the_last_bit(law, short):
    packing = relaxed(1000, periodic=False, seed=1)
    assert_same_field(*(demheat.solve(WALLED, packing=packing, **knobs) for knobs in ({"law": law}, short)))
    if "law" in short:
        fields = (demheat.evolve(WALLED, [0.1], packing=packing, **knobs) for knobs in ({"law": law}, short))
        assert_same_field(*(field for (field,) in fields))


def test_the_spacing_of_twins_in_gaps_is_a_keyword():
    assert Choices(gap_spacing=0.5).law("laguerre") == Laguerre(gap_spacing=0.5) != Laguerre()
    # The default may be given where there are no twins, as `dataclasses.replace` does.
    assert Choices(conforming=False, gap_spacing=0.85).law("laguerre") == Laguerre(conforming=False)
    for law in ("calibrated", "platonic"):
        with pytest.raises(ValueError, match=f"gap_spacing = 0.5 with law = '{law}': only the law 'laguerre' has"):
            demheat.solve(WALLED, law=law, gap_spacing=0.5)


CONTACT = [
    ({"sparse": "join"}, "sparse = 'join': must be one of nearest, keep, drop"),
    ({"wall": "face"}, "wall = 'face': must be one of center, surface"),
    ({"coordination": -1.0}, "coordination = -1.0: must be a finite number > 0"),
    ({"gap": -1.0}, "gap = -1.0: must be a finite part of r_i + r_j > -1"),
    ({"gap": 0.1, "coordination": 7.0}, "gap = 0.1, coordination = 7.0: one gives the other; pass one of them"),
    ({"interface": "median"}, "interface = 'median': must be one of harmonic, arithmetic"),
    ({"interface": None}, "interface = None: must be"),
]
WRONG = [
    *[(Calibrated, *wrong) for wrong in CONTACT],
    *[(Platonic, *wrong) for wrong in CONTACT],
    (Laguerre, *CONTACT[-2]),
    (Laguerre, *CONTACT[-1]),
    (Laguerre, {"gap_spacing": 0.9}, "gap_spacing = 0.9: must be a number above 0, at most 0.88"),
    (Laguerre, {"conforming": False, "gap_spacing": 0.5}, "gap_spacing = 0.5 with conforming = False: there are no"),
]


@pytest.mark.parametrize(("kind", "knobs", "words"), WRONG)
def test_a_wrong_choice_is_refused_by_its_law_and_by_its_short_form(kind, knobs, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        kind(**knobs)
    if None in knobs.values():
        # To `solve` that is the law's own default.
        return
    with pytest.raises(ValueError, match=re.escape(words)):
        demheat.solve(WALLED, law=kind.name, **knobs)
    with pytest.raises(ValueError, match=re.escape(words)):
        demheat.evolve(WALLED, [0.1], law=kind.name, **knobs)


@pytest.mark.parametrize(
    ("knobs", "words"),
    [
        ({"law": "voronoi"}, "law = 'voronoi': must be one of laguerre, calibrated, platonic"),
        ({"law": None}, "law = None: must be one of"),
        ({"law": Laguerre}, "must be one of laguerre, calibrated, platonic, or a law such as Laguerre()"),
        ({"law": Calibrated(), "sparse": "drop"}, "sparse beside law = Calibrated("),
        ({"law": Laguerre(), "conforming": True}, "conforming beside law = Laguerre("),
        ({"sparse": "drop"}, "sparse = 'drop' with law = 'laguerre': only the laws 'calibrated' and 'platonic'"),
        ({"gap": 0.1, "wall": "surface"}, "wall = 'surface', gap = 0.1 with law = 'laguerre'"),
        ({"law": "calibrated", "conforming": True}, "conforming = True with law = 'calibrated': twins need not touch"),
        ({"law": "platonic", "conforming": "no"}, "conforming = 'no': must be"),
        (
            # Made where it is asked for: whoever lists the tests would compile what packs it.
            {"packing": lambda: relaxed(200, periodic=False), "replicas": 2},
            "replicas = 2 of a packing that is given: must be None",
        ),
    ],
)
def test_what_does_not_go_together(knobs, words):
    knobs = {name: value() if name == "packing" else value for name, value in knobs.items()}
    with pytest.raises(ValueError, match=re.escape(words)):
        demheat.solve(BLOCK, **knobs)
    with pytest.raises(ValueError, match=re.escape(words)):
        demheat.evolve(BLOCK, [0.1], **knobs)


@pytest.mark.parametrize(
    ("law", "scene", "words"),
    [
        (Laguerre(), dataclasses.replace(SPHERE, inclusions=[BALL]), "a sphere: inclusions there have no conforming"),
        (Calibrated(wall="surface"), DRUM, "flat walls and that of a sphere"),
        (Platonic(wall="surface"), DRUM, "flat walls and that of a sphere"),
        (Platonic(), Scene((1, 1, 1), METAL, walls={"x-": 0.0, "y-": 1.0}, initial=0.0), "two held walls meet"),
    ],
)
def test_scenes_that_a_law_cannot_do(law, scene, words):
    with pytest.raises(NotImplementedError, match=words):
        law.check(scene)
    with pytest.raises(NotImplementedError, match=words):
        demheat.evolve(scene, [0.1], law=law)


# ---- A network alone -------------------------------------------------------------------------------------------------


def packed(scene):
    return relaxed(1000, periodic=scene.periodic, seed=2)


@pytest.mark.parametrize("law", [Laguerre(), Laguerre(conforming=False), Calibrated(sparse="drop"), Platonic()])
@pytest.mark.parametrize("scene", [WALLED, CELL])
def test_a_network_has_all_that_evaluation_needs(scene, law):
    network, packing = network_of(scene, packed(scene), law), packed(scene)
    n, m, w = len(network.volumes), len(network.indices), len(network.wall_particle)
    assert network.centers.shape == (n, 3) and network.radii.shape == (n,) and network.phase.shape == (n,)
    assert network.conductance.shape == network.area.shape == link_distances(network).shape == (m,)
    assert network.wall_area.shape == network.wall_conductance.shape == (w,) and (w > 0) == (not scene.periodic)
    assert_array_equal(network.periodic, [scene.periodic] * 3)
    assert_array_equal(network.size, packing.size)
    assert network.cells == isinstance(law, Laguerre)
    assert network.stats["law"] == law.name and ("twins" in network.stats["packing"]) == law.conforming
    assert_array_equal(network.phase, scene.phase_at(network.centers))
    # Conductances by hand, k S / d, with the parts of a link in series.
    row, k = row_numbers(network.indptr), scene.conductivities[network.phase]
    length = np.linalg.norm(
        branches(network.centers, network.size, network.indptr, network.indices, network.image), axis=1
    )
    share = np.clip(link_distances(network) / length, 0.0, 1.0)
    series = 1.0 / (share / k[row] + (1.0 - share) / k[network.indices])
    assert_allclose(network.conductance, series * network.area / length, rtol=1e-12)  # rounding
    walls = k[network.wall_particle] * network.wall_area / network.wall_distance
    assert_allclose(network.wall_conductance, walls, rtol=1e-14)


def test_the_calibrated_network_conducts_as_its_material_does():
    cell = Scene((1, 1, 1), METAL, gradient=(0.0, 1.0, 0.0))
    for scene in (cell, BLOCK):
        packing = packed(scene)
        network = network_of(scene, packing, Calibrated())
        found = network.stats["calibration"]
        given = network_of(scene, packing, Calibrated(factor=found))
        assert_array_equal(network.conductance, given.conductance)
        assert_array_equal(network.wall_conductance, given.wall_conductance)
        plain = network_of(scene, packing, Calibrated(factor=1.0))
        # C_t scales all links, those to walls too; rounding.
        assert_allclose(network.conductance, found * plain.conductance, rtol=1e-14)
        assert_allclose(network.wall_conductance, found * plain.wall_conductance, rtol=1e-14)
        # Two solves to 1e-8 on each particle's balance.
        conductivity = demheat.solve(scene, packing=packing, law=Calibrated()).conductivity
        assert_allclose(conductivity, METAL.conductivity, rtol=1e-4)


def test_choices_of_the_papers_that_only_the_object_has():
    packing = packed(CELL)
    arithmetic, harmonic = (
        network_of(CELL, packing, Calibrated(mean=m, factor=1.0)) for m in ("arithmetic", "harmonic")
    )
    # The harmonic mean of two radii is the lesser one.
    assert_array_equal(arithmetic.indices, harmonic.indices)
    assert np.all(harmonic.area <= arithmetic.area * (1 + 1e-14)) and np.any(harmonic.area < 0.9 * arithmetic.area)
    indptr, indices, _ = contacts(packing, coordination=7.5, additive=True)
    network = network_of(CELL, packing, Calibrated(sparse="keep", additive=True, factor=1.0))
    assert_array_equal(network.indptr, indptr)
    assert_array_equal(network.indices, indices)
    field = demheat.solve(CELL, packing=packing, law=Calibrated(mean="geometric", additive=True))
    assert 2.0 < field.conductivity < 20.0


def test_seeds_turn_the_twins():
    packing = packed(CELL)
    one, same, other = (network_of(CELL, packing, Laguerre(), seed=seed).centers for seed in (0, 0, 1))
    assert_array_equal(one, same)
    assert one.shape != other.shape or not np.array_equal(one, other)


def test_every_choice_is_at_work():
    """What laws may be asked for is what networks know: no name without a rule, nor the other way round."""
    packing = packed(BLOCK)
    for knob, valid in (("sparse", POLICIES), ("wall", WALL_RULES), ("interface", RULES)):
        found = [network_of(WALLED, packing, Platonic(gap=0.07, **{knob: value})) for value in valid]
        numbers = {(len(net.indices), net.conductance.sum(), net.wall_conductance.sum()) for net in found}
        assert len(numbers) == len(valid)
