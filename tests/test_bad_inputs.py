"""A table of nonsense: every public function, every argument, and what is no value of it.

Each is refused before any work with a ValueError that names the argument. A new public function needs a row here.
"""

# ruff: noqa: E501 (a row of the table is a line)

import inspect
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from solid_shapes import LIMITS, torus

import demheat
from demheat import damage, gallery, grains, packing, referee
from demheat.dem import evolve, solve, solve_axes
from demheat.dem.networks import network_of
from demheat.io import packings
from demheat.network.laguerre import laguerre
from demheat.packing import dispersion, domain, lsa, make_packing, neighbours, relax, statistics
from demheat.sampling import halo
from demheat.scene.negligible import negligible
from demheat.scene.symmetry import reduced, unfold
from demheat.terminal import slices
from references import bounds, bracket, exact, fem, fft, mesh, multipole, richardson, walkers
from references.exact import cracks, ellipsoids, fibres, inclined, lattice, squares
from references.fft import zeta

NAN, INF = float("nan"), float("inf")
HIDDEN = np.ma.array([0.5, 0.5, 0.5], mask=[False, True, False])
WORD = (None, "none such", 5, ["box"], True)
FLAG = (None, "False", 0, 1, [])
OBJECT = (None, "a", 5, [], object)
MATERIAL = (None, "steel", 33.0, object)
NUMBER = (None, "a", "0.5", NAN, INF, -INF, True, 1j, [0.5], np.array([0.5]), np.ma.masked, 10**400)
PART = (*NUMBER, -0.1)  # what is not negative
POSITIVE = (*PART, 0.0)
WHOLE = (None, "a", "5", NAN, 2.5, True, 1j, [5], -1)
COUNT = (*WHOLE, 0)
VECTOR = (None, "a", 0.5, ("0.5", "0.5", "0.5"), (0.5, 0.5), (0.5,) * 4, (NAN, 0.5, 0.5), (INF, 0.5, 0.5), HIDDEN)
VECTOR = (*VECTOR, (True, 0.5, 0.5), (1j, 0.5, 0.5), (None, 0.5, 0.5), [[0.5, 0.5, 0.5]], {0.5})
SIDES = (*VECTOR, (0.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (1e-300,) * 3, (1e300,) * 3)
PLACES = (None, "a", 0.5, [["0.5"] * 3], [[NAN, 0.5, 0.5]], [[1j, 0.5, 0.5]], [[0.5, 0.5]])
PLACES = (*PLACES, np.ma.array([[0.5] * 3], mask=True))
RADII = (
    packing.Gaussian,
    packing.Listed,
    "a",
    5,
    [1e-300, 1e300, "a"],
    ["1", "2"],
    [NAN, 1.0],
    [-1.0, 1.0],
    [0.0, 1.0],
    [1j, 1.0],
    [[1.0, 2.0]],
)
TIMES = (
    None,
    "a",
    [],
    ["1"],
    [NAN],
    [INF],
    [5e-324],
    [1e51],
    [-1.0],
    [2.0, 1.0],
    [1.0, 1.0],
    [True],
    [1j],
    [[1.0, 2.0]],
    HIDDEN,
)
SERIES = (None, "a", 5.0, [], ["1", "2", "3"], [1j, 2.0, 3.0], [1.0, 2.0])
PAIR = (None, "a", 5, (1.0,), (1.0, 2.0, 3.0), ("1", "2"), (NAN, 1.0), (True, 1.0), (1j, 1.0))
CURVE = (None, "a", 5.0, [], ["1", "2"])
# Bounds and estimates broadcast, and have limits at 0 and infinity.
ARRAY = (None, "a", "0.5", NAN, -1.0, True, 1j, [1.0, "a"], np.ma.masked, 10**400)
SHARE = (*ARRAY, INF, 1.5, [0.5, 1.1])


def round_set(points):
    """Below 0 in a ball."""
    return np.linalg.norm(points - 0.5, axis=1) - 0.25


def without(values, *left_out):
    """The values but for some that an argument may have."""
    return tuple(value for value in values if repr(value) not in map(repr, left_out))


def or_none(values):
    return values[1:]


ZERO = (0.0, 0.0, 0.0)
TURN = ("a", 0.5, (0.5, 0.5), (NAN, 0.0, 0.0), HIDDEN, np.ones((3, 3)), np.eye(2), -np.eye(3), 1.01 * np.eye(3))
TENSORS = ([1, 2, 3], [[1, 0, 0], [0, 1, 0.1], [0, 0, 1]], [[1, 2, 0], [2, 1, 0], [0, 0, 1]])
TENSORS = (*TENSORS, np.diag([1, 1, 1e-11]), np.diag([1e60, 1, 1]), np.eye(3) * 1j)
RESISTANCE = (-1e-9, 1e-60, None)
# Closed forms take what is a number.
FORM = (-1.0, NAN)
METAL = demheat.Material(1.0, 1.0, 1.0)
OTHER = demheat.Material(5.0)
CUBE = {"size": (1.0, 1.0, 1.0), "matrix": METAL}
CELL = demheat.Scene(**CUBE, gradient=(1.0, 0.0, 0.0))
WALLED = demheat.Scene(**CUBE, walls={"x-": 0.0, "x+": 1.0})
WARMING = demheat.Scene(**CUBE, walls={"x-": 0.0, "x+": 1.0}, initial=0.0)
BALL = demheat.Scene(**CUBE, inclusions=[demheat.Sphere((0.5, 0.5, 0.5), 0.25, OTHER)], gradient=(1.0, 0.0, 0.0))
SITES = np.stack(np.meshgrid(*[[0.25, 0.75]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
EIGHT = make_packing(SITES, np.full(8, 0.24), (1, 1, 1), True, {})
ROWS = {"packing": EIGHT, "indptr": np.zeros(9, np.int64), "indices": np.empty(0, np.int64)}
SOLVED = exact.solve(WALLED, points_per_axis=2)
OF_PARTICLES = replace(SOLVED, stats={"mean_radius": 0.05})
TWO = {"k_matrix": 1.0, "k_inclusion": 2.0, "fraction": 0.1}
TWO_BAD = {"k_matrix": ARRAY, "k_inclusion": ARRAY, "fraction": SHARE}
CUBIC = {
    "contrast": without(PART, INF),
    "fraction": POSITIVE,
    "edge": POSITIVE,
    "matrix": MATERIAL,
    "axis": (*WHOLE, 3),
}
FACTORS = (
    None,
    "a",
    5,
    [],
    [(0.0, 1.0)],
    [(0.0, 1.0), (0.0, 2.0)],
    [(0.0, 1.0), (1.0, 0.0)],
    [(0.0, 1.0), (1.0, INF)],
    [(0, 1, 2), (1, 2, 3)],
    [("0", 1), (1, 1)],
    HIDDEN,
)
LAWS = {
    "interface": WORD,
    "sparse": WORD,
    "wall": WORD,
    "coordination": or_none(POSITIVE),
    "gap": or_none((*NUMBER, -1.0)),
}
MOVING = {"axis": 0, "diameter": 0.1, "power_density": 1.0, "start": (0.5, 0.5)}
BOUNDS = ("maxwell", "hashin_shtrikman", "bruggeman", "bruggeman_differential", "rayleigh")

# Function, good arguments, and what is bad of which.
TABLE = [
    (demheat.Material, {"conductivity": 1.0}, {"conductivity": (*without(PART, INF), *TENSORS), "density": or_none(POSITIVE), "heat_capacity": or_none(POSITIVE)}),
    (demheat.Material, {"conductivity": 1.0}, {"dependence": or_none(FACTORS)}),
    (demheat.Image, {"labels": np.zeros((2, 2, 2), int), "voxel": 0.1, "materials": {0: OTHER}}, {"labels": (None, "a", 0.5, np.zeros((2, 2)), np.zeros((2, 2, 2)), np.ones((2, 2, 2), int), np.zeros((0, 2, 2), int)), "voxel": (*POSITIVE, (0.1, 0.1)), "materials": (None, [OTHER], {"a": OTHER}, {0: 1.0}, {})}),
    (demheat.Dependence, {"points": [(0.0, 1.0), (1.0, 2.0)]}, {"points": FACTORS}),
    (demheat.orthotropic, {"k1": 1.0, "k2": 2.0, "k3": 3.0}, {"k1": POSITIVE, "k3": POSITIVE, "rotation": TURN}),
    (demheat.Sphere, {"center": (0.5,) * 3, "radius": 0.2, "material": OTHER}, {"center": VECTOR, "radius": POSITIVE, "material": MATERIAL, "resistance": RESISTANCE}),
    (demheat.Layer, {"axis": 0, "start": 0.2, "stop": 0.4, "material": OTHER}, {"axis": (*WHOLE, 3), "start": NUMBER, "stop": POSITIVE, "material": MATERIAL, "resistance": RESISTANCE}),
    (demheat.Box, {"center": (0.5,) * 3, "sides": (0.2,) * 3, "material": OTHER}, {"center": VECTOR, "sides": VECTOR, "material": MATERIAL, "rotation": TURN, "resistance": RESISTANCE}),
    (demheat.Cylinder, {"center": (0.5,) * 3, "radius": 0.2, "axis": (0, 0, 1), "material": OTHER}, {"center": VECTOR, "radius": POSITIVE, "axis": (*VECTOR, ZERO), "material": MATERIAL, "length": or_none(POSITIVE)}),
    (demheat.Ellipsoid, {"center": (0.5,) * 3, "semi_axes": (0.2,) * 3, "material": OTHER}, {"center": VECTOR, "semi_axes": (*VECTOR, (1, 1, 0)), "material": MATERIAL, "rotation": TURN}),
    (demheat.Torus, {"center": (0.5,) * 3, "radius": 0.3, "tube": 0.1, "axis": (0, 0, 1), "material": OTHER}, {"center": VECTOR, "radius": POSITIVE, "tube": POSITIVE, "axis": VECTOR, "material": MATERIAL}),
    (demheat.HalfSpace, {"point": (0.5,) * 3, "outward": (0, 0, 1), "material": OTHER}, {"point": VECTOR, "outward": (*VECTOR, ZERO), "material": MATERIAL}),
    (demheat.SurfaceMesh, {"vertices": np.eye(4, 3), "triangles": np.array([(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)]), "material": OTHER}, {"vertices": (None, "a", np.eye(3), np.full((4, 3), np.nan)), "triangles": (None, "a", 1.5, [(0, 1, 9)]), "material": MATERIAL}),
    (demheat.LevelSet, {"function": round_set, "limits": ((0.2,) * 3, (0.8,) * 3), "material": OTHER}, {"function": (None, 1.0, "a"), "limits": (None, "a", 0.5, ((0.2,) * 3,), ((0.8,) * 3, (0.2,) * 3)), "material": MATERIAL}),
    (demheat.LevelSet, {"function": torus, "limits": LIMITS, "material": OTHER}, {"limits": (((0, 0, 0), (1, 1, 0)), ((0.3,) * 3, (0.7,) * 3)), "function": (lambda p: 1 + p[:, 0] ** 2, lambda p: p, lambda p: torus(p) + 0j)}),
    (demheat.Union, {"shapes": (demheat.Sphere((0.5,) * 3, 0.2, OTHER),) * 2, "material": OTHER}, {"shapes": (None, "ab", 0.5, (), (1, 2), (demheat.Sphere((0.5,) * 3, 0.2, OTHER),), (demheat.Layer(0, 0.2, 0.4, OTHER),) * 2), "material": (*MATERIAL, METAL)}),
    (demheat.Flux, {}, {"value": NUMBER}),
    (demheat.Convection, {"coefficient": 1.0, "temperature": 1.0}, {"coefficient": (*POSITIVE, 1e300), "temperature": (*NUMBER, 1e300)}),
    (demheat.Radiation, {"emissivity": 0.5, "temperature": 1.0}, {"emissivity": (*POSITIVE, 1.01, 1e-300), "temperature": (*PART, 1e300)}),
    (demheat.UniformSource, {}, {"power_density": (*POSITIVE, 1e300)}),
    (demheat.MovingCylinder, MOVING, {"axis": (*WHOLE, 3), "diameter": (*POSITIVE, 1e-300), "power_density": (*POSITIVE, 1e300), "start": PAIR, "velocity": PAIR, "clip": FLAG}),
    (demheat.Scene, CUBE | {"gradient": (1, 0, 0)}, {"size": SIDES, "matrix": MATERIAL, "gradient": (*without(VECTOR, None), (0.0, 0.0, 0.0))}),
    (demheat.Scene, CUBE | {"gradient": (1, 0, 0)}, {"inclusions": (None, "a", 5, [None], ["a"], [METAL], object), "sources": (None, "a", 5, [METAL]), "domain": WORD}),
    (demheat.Scene, CUBE | {"walls": {"x-": 0.0}}, {"initial": or_none((*NUMBER, 1e300))}),
    (demheat.Scene, CUBE, {"walls": ("a", 5, {}, {"q": 1.0}, {1: 1.0}, {"round": 1.0}, *({"x-": value} for value in NUMBER))}),
    (demheat.Laguerre, {}, {"conforming": FLAG, "interface": WORD}),
    (demheat.Calibrated, {}, LAWS | {"mean": WORD, "additive": FLAG, "factor": or_none(POSITIVE)}),
    (demheat.Platonic, {}, LAWS),
    (demheat.on_progress, {}, {"hook": ("a", 5, [])}),
    (demheat.budget, {}, {"seconds": or_none(POSITIVE)}),
    (solve, {"scene": CELL, "packing": EIGHT}, {"scene": OBJECT, "law": WORD, "seed": WHOLE, "solver": WORD, "tolerance": POSITIVE, "seconds": or_none(POSITIVE), "packing": or_none(OBJECT), "allow_few": FLAG}),
    (solve_axes, {"scene": CELL, "packing": EIGHT}, {"scene": OBJECT, "law": WORD, "seed": WHOLE, "solver": WORD, "tolerance": POSITIVE, "packing": or_none(OBJECT), "allow_few": FLAG}),
    (solve, {"scene": CELL, "packing": EIGHT}, {"conforming": or_none(FLAG), "interface": or_none(WORD), "replicas": or_none(COUNT)}),
    (solve, {"scene": CELL, "law": "calibrated", "packing": EIGHT}, {"sparse": or_none(WORD), "wall": or_none(WORD), "coordination": or_none(POSITIVE), "gap": or_none(NUMBER)}),
    (solve, {"scene": CELL, "allow_few": True}, {"particles": COUNT}),
    (solve, {"scene": CELL, "particles": 10_000}, {"replicas": (3,)}),
    (damage.solve, {"scene": CELL}, {"scene": OBJECT, "removed": SHARE, "draw": WHOLE, "cracks": (None, "a", 5, [None]), "particles": COUNT, "solver": (*WORD, "lu"), "law": WORD, "seed": WHOLE, "tolerance": POSITIVE}),
    (damage.debonded, {"scene": BALL, "share": 0.5, "seed": 0}, {"scene": OBJECT, "share": SHARE, "seed": WHOLE, "resistance": or_none((*POSITIVE, 1e60))}),
    (damage.Disc, {"center": ZERO, "radius": 1.0, "normal": (0, 0, 1)}, {"center": VECTOR, "radius": POSITIVE, "normal": (*VECTOR, ZERO)}),
    (damage.Rectangle, {"center": ZERO, "along": (1, 0, 0), "across": (0, 1, 0)}, {"center": VECTOR, "along": (*VECTOR, ZERO), "across": (*VECTOR, ZERO, (1, 1, 0))}),
    (grains.Gap, {"conductivity": 0.03}, {"conductivity": POSITIVE, "disc": (*POSITIVE, 3), "widest": PART}),
    (grains.Fixed, {"ratio": 0.1}, {"ratio": (*POSITIVE, 1.0), "within": PART}),
    (grains.Hertz, {}, {"young": or_none(POSITIVE), "poisson": (*NUMBER, 0.6)}),
    (laguerre, {"centers": SITES, "weights": np.zeros(8), "size": (1, 1, 1)}, {"centers": (np.zeros((0, 3)), SITES + 2, SITES * NAN), "weights": (np.full(8, INF), np.ones(4))}),
    (negligible, {"scene": BALL, "accuracy": 0.1}, {"scene": OBJECT, "accuracy": (*POSITIVE, 1.0)}),
    (evolve, {"scene": WARMING, "times": [1.0], "allow_few": True}, {"scene": OBJECT, "times": TIMES, "law": WORD, "particles": COUNT, "seed": WHOLE, "packing": or_none(OBJECT)}),
    (evolve, {"scene": WARMING, "times": [1.0], "law": "calibrated", "allow_few": True}, {"integrator": WORD, "accuracy": POSITIVE, "step": or_none(POSITIVE), "wall": or_none(WORD), "allow_few": FLAG}),
    (network_of, {"scene": CELL, "packing": EIGHT, "law": demheat.Laguerre()}, {"scene": OBJECT, "packing": OBJECT, "law": WORD}),
    (gallery.slab, {}, {"size": SIDES, "material": MATERIAL, "periodic": FLAG, "axis": (*WHOLE, 3), "temperatures": PAIR}),
    (gallery.laminate, {}, {"direction": WORD, "contrast": without(PART, INF), "layers": COUNT, "edge": POSITIVE, "matrix": MATERIAL, "axis": (*WHOLE, 3), "periodic": FLAG}),
    (gallery.sphere_in_cube, {}, {"contrast": without(PART, INF), "radius": or_none(POSITIVE), "fraction": or_none(POSITIVE), "edge": POSITIVE, "matrix": MATERIAL, "temperatures": PAIR}),
    (gallery.simple_cubic, {}, CUBIC),
    (gallery.body_centred, {}, CUBIC),
    (gallery.face_centred, {}, CUBIC),
    (gallery.coated_sphere, {}, {"core": PART, "shell": PART, "radius": POSITIVE, "core_fraction": (*POSITIVE, 1.0), "center": VECTOR, "edge": POSITIVE}),
    (gallery.random_dispersion, {}, {"count": or_none(COUNT), "fraction": or_none(POSITIVE), "diameter": POSITIVE, "gap": PART, "seed": WHOLE, "edge": POSITIVE, "matrix": MATERIAL, "inclusion": MATERIAL, "periodic": FLAG}),
    (gallery.dispersion, {"count": 4}, {"count": COUNT, "fraction": POSITIVE, "ratio": POSITIVE, "gap": PART, "seed": WHOLE, "edge": POSITIVE, "matrix": MATERIAL, "inclusion": MATERIAL, "periodic": FLAG}),
    (gallery.random_dispersion, {"count": 1, "gap": 0.4, "periodic": False}, {"diameter": (0.6, 1.0)}),
    (gallery.dispersion, {"count": 20}, {"count": (1,), "ratio": (0.5,), "fraction": (0.7,)}),
    (gallery.scaled, {"material": METAL, "contrast": 2.0}, {"material": MATERIAL, "contrast": without(PART, INF)}),
    (gallery.loaded, {"size": (1, 1, 1)}, {"size": VECTOR, "periodic": FLAG, "axis": (*WHOLE, 3), "temperatures": PAIR}),
    (dispersion.dispersion, {"number": 4}, {"number": or_none(COUNT), "fraction": POSITIVE, "size": SIDES, "radii": RADII, "periodic": FLAG, "gap": PART, "method": WORD, "seed": WHOLE}),
    (dispersion.dispersion, {}, {"ratio": or_none(POSITIVE), "folder": (5, True, [])}),
    (dispersion.dispersion_scene, {"number": 4, "matrix": METAL, "inclusion": OTHER}, {"matrix": MATERIAL, "inclusion": MATERIAL, "load": or_none(WORD), "axis": (*WHOLE, 3), "temperatures": PAIR}),
    (packing.Gaussian, {}, {"spread": PART, "cut": POSITIVE}),
    (packing.Uniform, {}, {"half_width": (*PART, 1.0)}),
    (packing.Lognormal, {}, {"spread": PART, "cut": POSITIVE}),
    (packing.Bidisperse, {}, {"ratio": POSITIVE, "fraction": PART}),
    (packing.Listed, {}, {"values": (None, [], *RADII)}),
    (make_packing, {"centers": [[0.5] * 3], "radii": [0.1], "size": (1, 1, 1), "periodic": True, "provenance": {}}, {"centers": PLACES, "radii": (None, *RADII), "size": SIDES, "periodic": FLAG, "provenance": (None, "a", 5), "domain": WORD}),
    (packing.relaxed, {"number": 8, "allow_few": True}, {"size": SIDES, "radii": RADII, "periodic": FLAG}),
    (packing.grown, {"number": 8, "allow_few": True}, {"size": SIDES, "radii": RADII, "periodic": FLAG, "start": (EIGHT,)}),
    (relax.relax, {"number": 8, "allow_few": True}, {"number": COUNT, "size": SIDES, "phi": POSITIVE, "radii": RADII, "periodic": FLAG, "domain": WORD, "seed": WHOLE, "allow_few": FLAG, "overlap": PART, "steps": WHOLE, "progress": ("a", 5)}),
    (relax.relax, {"number": 200}, {"phi": (0.75,), "radii": ([1.0, 2.0],), "size": ((1, 1, 0.2),)}),
    (relax.relax, {"number": 200, "periodic": False}, {"size": ((1, 1, 0.02),)}),
    (lsa.lsa, {"number": 200, "phi": 0.5}, {"phi": (1.0,), "pressure": (9.0,), "growth": ([(5.0, 0.1), (1.0, 0.1)],), "radii": (np.ones(5),), "size": ((1, 1, 0.2),), "domain": ("sphere",)}),
    (lsa.lsa, {"number": 8, "allow_few": True, "phi": 0.1}, {"number": COUNT, "size": SIDES, "phi": or_none(POSITIVE), "radii": RADII, "periodic": FLAG, "domain": WORD, "seed": WHOLE, "allow_few": FLAG}),
    (lsa.lsa, {"number": 8, "allow_few": True, "phi": 0.1}, {"pressure": or_none(POSITIVE), "most": POSITIVE, "growth": (*without(POSITIVE, [0.5]), [], [(1, 2, 3)]), "progress": ("a", 5), "start": ("a", 5)}),
    (packing.settle, {"packing": EIGHT}, {"packing": OBJECT, "fixed": ("a", 5, [True], np.ones(8)), "steps": WHOLE, "overlap": PART, "progress": ("a", 5)}),
    (packings.write, {"packing": EIGHT, "path": "nowhere/none.npz"}, {"packing": OBJECT, "path": (None, 5, "", "none", "a\0.npz"), "format": or_none((5, "box", ["npz"])), "temperature": ([1.0] * 8,)}),
    (packings.read, {"path": "nowhere/none.xyz"}, {"path": (None, 5, "", "none", "a\0.npz"), "format": or_none((None, 5, "box", ["npz"])), "size": or_none(SIDES), "periodic": or_none(FLAG), "domain": or_none((None, 5, "box ", ["box"])), "step": (True, 1.0, "a"), "order": WORD}),
    (neighbours.neighbours, {"packing": EIGHT}, {"packing": OBJECT, "scale": PART, "skin": PART}),
    (packing.contacts, {"packing": EIGHT, "coordination": 3.0}, {"packing": OBJECT, "gap": or_none((*NUMBER, -1.0)), "additive": FLAG, "coordination": POSITIVE, "margin": PART}),
    (packing.cut, {"packing": EIGHT}, {"packing": OBJECT, "domain": WORD, "size": (*or_none(SIDES), (2, 1, 1), (0.01,) * 3), "center": or_none(VECTOR), "keep": WORD}),
    (packing.cut, {"packing": EIGHT, "domain": "sphere"}, {"size": ((0.5, 0.6, 0.5),)}),
    (packing.replicate, {"packing": EIGHT, "repeats": (1, 1, 2)}, {"packing": OBJECT, "repeats": (None, "a", 2, (1, 1), (0, 1, 1), (1.5, 1, 1), (True, True, True), ("1", "1", "1"), (-1, 1, 1))}),
    (domain.replica_counts, {"number": 8000, "size": (1, 1, 1)}, {"number": COUNT, "size": SIDES, "replicas": or_none(COUNT)}),
    (EIGHT.scaled, {}, {"factor": POSITIVE}),
    (statistics.packing_fraction, {"packing": EIGHT}, {"packing": OBJECT, "margin": PART}),
    (statistics.radial_distribution, {"packing": EIGHT, "r_max": 0.9}, {"packing": OBJECT, "r_max": POSITIVE, "bins": COUNT, "scaled": FLAG}),
    (statistics.two_point, {"packing": EIGHT, "r_max": 0.9}, {"packing": OBJECT, "along": (None, "a", 5, [], [(0, 0, 0)], [(NAN, 1, 1)], [("1", "0", "0")], [(1j, 0, 0)]), "r_max": POSITIVE, "points": COUNT, "lines": COUNT, "margin": PART, "seed": WHOLE}),
    (statistics.coordination, ROWS, {"packing": OBJECT, "indptr": (None, "a", 5, [], np.zeros(9)), "indices": (None, "a", 5, np.ones(1), [1]), "margin": PART}),
    (statistics.backbone, ROWS, {"packing": OBJECT, "indptr": (None, "a"), "indices": (None, "a"), "gap": (*NUMBER, -1.0), "rule": WORD}),
    (statistics.fabric, ROWS, {"packing": OBJECT, "indptr": (None, "a"), "indices": (None, "a"), "margin": PART}),
    (statistics.directions, ROWS, {"packing": OBJECT, "indptr": (None, "a"), "indices": (None, "a"), "bins": (*COUNT, 5), "margin": PART}),
    (slices.plane, {"scene": CELL, "axis": 0, "at": 0.5, "n": 3}, {"scene": OBJECT, "axis": (*WHOLE, 3), "at": PART, "n": COUNT}),
    (slices.on_plane, {"field": SOLVED, "axis": 0, "at": 0.5, "n": 3}, {"field": OBJECT, "axis": (*WHOLE, 3), "at": PART, "n": COUNT, "flux_at": ("a", 5, lambda p: None, lambda p: "a", lambda p: 5.0, lambda p: p[:, 0], lambda p: p[:1], lambda p: p * 1j)}),
    (slices.filled, {"mask": np.ones((2, 2), bool), "values": np.ones(4)}, {"mask": (None, "a", np.ones((2, 2)), np.ones(4, bool)), "values": (None, 5.0, ["a"] * 4, [1j] * 4, [1.0])}),
    (halo.halo_flux, {"field": OF_PARTICLES}, {"field": OBJECT, "ratio": or_none(POSITIVE), "walls": WORD, "same_phase": FLAG, "at": ([0.5, 1.5],)}),
    (halo.halo_flux, {"field": OF_PARTICLES, "walls": "mirror"}, {"ratio": (21.0,)}),
    (halo.halo_average, {"points": [[0.5] * 3], "values": [1.0], "volumes": [1.0], "radius": 0.1, "size": (1, 1, 1), "periodic": True}, {"points": PLACES, "values": (None, "a", ["1"], [NAN], [1j], [1.0, 2.0]), "volumes": (None, ["1"], [NAN], [-1.0]), "radius": POSITIVE, "size": SIDES, "periodic": FLAG}),
    (SOLVED.temperature_at, {}, {"points": PLACES}),
    (SOLVED.flux_at, {}, {"points": PLACES}),
    (SOLVED.heat_through, {"axis": 0, "position": 0.5}, {"axis": (*WHOLE, 3), "position": PART}),
    (referee.conductivity_error, {"field": SOLVED, "reference": 1.0}, {"field": OBJECT, "reference": POSITIVE}),
    (referee.temperature_error, {"field": SOLVED, "reference": SOLVED}, {"field": OBJECT, "reference": OBJECT, "points": without(PLACES, None), "values": ("a", 5, [1.0], ["1"] * 8, np.ones((8, 2))), "mask": ("a", 5, [True]), "unit": WORD}),
    (referee.flux_error, {"field": SOLVED, "reference": SOLVED}, {"field": OBJECT, "reference": OBJECT, "points": without(PLACES, None), "values": ("a", 5, np.ones(8), np.ones((8, 2))), "unit": WORD, "along": FLAG}),
    (referee.temperature_error(SOLVED, SOLVED).part, {}, {"mask": (None, "a", [True], np.ones(8))}),
    (referee.heat_balance, {}, {"field": OBJECT}),
    (referee.span, {"scene": WALLED}, {"scene": OBJECT, "reference": or_none(OBJECT)}),
    (referee.bound_violation, {"field": 1.0, "lower": 0.0, "upper": 2.0}, {"field": (None, "a", [], 1j, True), "lower": without(PART, 10**400), "upper": without(PART, INF, 10**400)}),
    (referee.value_error, {"found": 1.0, "exact": 2.0}, {"found": (None, "a", 1j), "exact": (None, "a", 1j, 0.0), "scale": ("a", "1", 0.0)}),
    (referee.value_error, {"found": [1.0, 2.0], "exact": [1.0, 2.0]}, {"found": ([1.0] * 3,), "exact": ([1.0] * 3,)}),
    (referee.vector_error, {"found": np.ones((2, 3)), "exact": np.ones((2, 3))}, {"found": (np.ones((4, 3)),), "exact": (np.ones((4, 3)),)}),
    (referee.vector_error, {"found": [1.0, 2.0], "exact": [1.0, 2.0]}, {"found": (None, "a", 1.0, [1.0] * 3), "exact": (None, "a", 1.0), "scale": POSITIVE}),
    (referee.rms, {"errors": [1.0, 2.0]}, {"errors": CURVE, "weights": ("a", [1.0], [0.0, 0.0], [-1.0, 1.0], [INF, 1.0])}),
    (referee.variation, {"values": [1.0, 2.0]}, {"values": (*CURVE, [0.0, 0.0]), "weights": ("a", [1.0], [0.0, 0.0], [-1.0, 1.0], [INF, 1.0])}),
    (referee.worst, {}, {"errors": (*CURVE, [[1.0, 2.0], [3.0, 4.0]])}),
    (referee.curve_error, {"curve": [1.0, 2.0], "reference": [1.0, 2.0]}, {"curve": (*CURVE, [1.0]), "reference": (*CURVE, [1.0, 2.0, 3.0], [0.0, 0.0])}),
    (referee.dispersion, {}, {"curves": (*CURVE, [1.0, 2.0], [[0.0, 0.0]])}),
    (unfold, {"part": reduced(CELL), "points": [[0.5] * 3]}, {"part": (None, "a", CELL), "points": PLACES}),
    (exact.solve, {"scene": WALLED}, {"scene": OBJECT, "points_per_axis": COUNT}),
    (demheat.effective, {"scene": CELL}, {"scene": OBJECT, "accuracy": (*POSITIVE, 1.0), "method": ("a", 5, ["box"], object, b"fem", [], {"fem"}), "memory": or_none(POSITIVE), "seconds": or_none(POSITIVE)}),
    (demheat.recommend, {"scene": CELL}, {"scene": OBJECT, "accuracy": (*POSITIVE, 1.0), "memory": or_none(POSITIVE)}),
    (demheat.sweep, {"function": abs, "cases": [{"x": 1.0}]}, {"function": (None, "a", 5, []), "cases": (None, "a", 5, [], {}, [5], [{}], [{5: 1}], {"x": []}, {"x": "ab"}, {"x": 5}, {"x": {1, 2}}, {5: [1]}, {"error": [1]}, [{"when": 1}], np.ones(3)), "client": ("a", 5, object(), True), "out": (5, "a\0.csv", "nowhere/none.csv", "."), "timeout": (*or_none(POSITIVE), 5.0)}),
    (exact.solve_axes, {"scene": WALLED}, {"scene": OBJECT, "points_per_axis": COUNT}),
    (exact.evolve, {"scene": WARMING, "times": [1.0]}, {"scene": OBJECT, "times": TIMES, "points_per_axis": COUNT}),
    (fem.solve, {"scene": WALLED}, {"scene": OBJECT, "order": (*COUNT, 3), "size": or_none(POSITIVE), "curved": FLAG, "tolerance": POSITIVE}),
    (fem.solve_axes, {"scene": WALLED}, {"scene": OBJECT, "order": (*COUNT, 3), "size": or_none(POSITIVE), "curved": FLAG, "tolerance": POSITIVE}),
    (fem.evolve, {"scene": WARMING, "times": [1.0], "elements": "hexahedra"}, {"scene": OBJECT, "times": TIMES, "order": or_none((*COUNT, 2)), "size": or_none(POSITIVE), "elements": WORD, "step": or_none(POSITIVE), "accuracy": POSITIVE, "tolerance": POSITIVE}),
    (mesh.make, {"scene": CELL}, {"scene": OBJECT, "size": or_none(POSITIVE), "order": (*COUNT, 3), "curved": FLAG}),
    (fft.solve, {"scene": BALL, "voxels": 4}, {"scene": OBJECT, "voxels": (*without(or_none(COUNT), [5]), (4, 4), ("4",) * 3, (4.5, 4, 4), (True, 4, 4), (0, 4, 4)), "scheme": WORD, "rule": WORD, "precision": WORD, "threads": or_none(COUNT), "tolerance": or_none(POSITIVE), "max_iterations": COUNT}),
    (fft.solve_axes, {"scene": BALL, "voxels": 4}, {"scene": OBJECT, "voxels": (*without(or_none(COUNT), [5]), (4, 4), ("4",) * 3, (4.5, 4, 4), (True, 4, 4), (0, 4, 4)), "scheme": WORD, "rule": WORD, "precision": WORD, "threads": or_none(COUNT), "tolerance": or_none(POSITIVE), "max_iterations": COUNT}),
    (zeta.zeta2, {"scene": BALL, "voxels": 32}, {"scene": OBJECT, "voxels": without(COUNT, [5]), "extrapolate": FLAG, "threads": or_none(COUNT)}),
    (multipole.solve, {"scene": BALL, "order": 3}, {"scene": OBJECT, "order": or_none(COUNT), "accuracy": or_none(POSITIVE), "tolerance": or_none(POSITIVE), "points_per_axis": COUNT, "threads": COUNT}),
    (multipole.solve_axes, {"scene": BALL, "order": 3}, {"scene": OBJECT, "order": or_none(COUNT), "accuracy": or_none(POSITIVE), "tolerance": or_none(POSITIVE), "points_per_axis": COUNT, "threads": COUNT}),
    (multipole.zeta2, {"scene": BALL, "order": 3}, {"scene": OBJECT, "order": or_none(COUNT)}),
    (bracket.solve, {"scene": WALLED}, {"scene": OBJECT, "size": or_none(POSITIVE), "width": or_none(POSITIVE), "tolerance": (*POSITIVE, 1.0)}),
    (bracket.solve_tensor, {"scene": CELL}, {"scene": OBJECT, "size": or_none(POSITIVE), "tolerance": (*POSITIVE, 1.0)}),
    (bracket.voxels.solve, {"scene": BALL}, {"scene": OBJECT, "voxels": without(or_none(COUNT), [5]), "tolerance": (*POSITIVE, 2.0), "threads": or_none(COUNT)}),
    (bracket.voxels.bounds, {"conductivity": np.ones((2, 2, 2))}, {"conductivity": (None, "copper", np.ones((2, 2)), -np.ones((2, 2, 2)), np.full((2, 2, 2), 1e60)), "spacing": SIDES[:-2], "gradient": (*VECTOR, ZERO), "refine": (*COUNT, 10**6), "tolerance": POSITIVE, "threads": or_none(COUNT)}),
    (walkers.solve, {"scene": BALL}, {"scene": OBJECT, "walks": (*COUNT, 99), "radius": or_none(POSITIVE), "seed": WHOLE}),
    *((method.solve_axes, {"scene": CELL}, {"scene": OBJECT}) for method in (exact, fem, fft, multipole)),
    (bounds.estimate, {"scene": BALL}, {"scene": OBJECT, "formula": WORD}),
    (bounds.voigt, {"conductivities": [1.0, 2.0], "fractions": [0.5, 0.5]}, {"conductivities": (None, "a", ["1", "2"], [NAN, 1.0], [-1.0, 1.0], [1.0, 2.0, 3.0], [1j, 1.0], [True, True]), "fractions": (None, "a", ["0.5", "0.5"], [0.5, 0.6], [-0.5, 1.5], [NAN, 1.0])}),
    (bounds.reuss, {"conductivities": [1.0, 2.0], "fractions": [0.5, 0.5]}, {"conductivities": (None, "a", [NAN, 1.0], [-1.0, 1.0], [1.0, 2.0, 3.0]), "fractions": (None, "a", [0.5, 0.6], [NAN, 1.0])}),
    (bounds.voigt, {"conductivities": 1.0}, {"fractions": (1.0,)}),
    *((getattr(bounds, name), TWO, TWO_BAD | {"k_inclusion": ARRAY}) for name in BOUNDS),
    *((getattr(bounds, name), TWO | {"k_matrix": [1.0, 2.0]}, {"fraction": ([0.1, 0.2, 0.3],)}) for name in BOUNDS),
    (bounds.rayleigh, TWO, {"fraction": (0.53,)}),
    (bounds.agari_uno, TWO, TWO_BAD | {"c1": (*ARRAY, INF, 0.0), "c2": SHARE}),
    (bounds.lewis_nielsen, TWO, TWO_BAD | {"fraction": (*SHARE, 0.65), "shape": (*ARRAY, INF, 0.0), "packing": (*SHARE, 0.0)}),
    (bounds.torquato, TWO | {"zeta2": 0.1}, TWO_BAD | {"zeta2": (*SHARE, 0.9, [0.1, 0.51])}),
    (bounds.third_order, TWO | {"zeta2": 0.1}, TWO_BAD | {"zeta2": SHARE}),
    (bounds.zeta2_hard_spheres, {}, {"fraction": (*SHARE, 0.7)}),
    (richardson.extrapolate, {"values": [1.0, 2.0, 3.0], "sizes": [1.0, 0.5, 0.2]}, {"values": (*SERIES, [NAN, 1.0, 2.0]), "sizes": (*SERIES, [0.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0]), "order": (*without(or_none(POSITIVE), [0.5], np.array([0.5])), [[1, 2]], [[1], [1, 2]], (1, 1))}),
    # From both sides of a limit; with no limit, differences growing; not changing at all.
    (richardson.extrapolate, {"values": [1.0, 1.5, 1.75], "sizes": [1.0, 0.5, 0.25]}, {"values": ([1.0, 2.0, 1.5], [1.0, 2.0, 4.0], [1.0] * 3)}),
    (richardson.observed_order, {"values": [1.0, 1.5, 1.75], "sizes": [1.0, 0.5, 0.25]}, {"values": SERIES, "sizes": SERIES}),
    (ellipsoids.depolarisation, {}, {"axes": ((1, 2), (1, 0, 1))}),
    (ellipsoids.polarisability, {"contrast": 2.0, "axes": (1, 1, 1)}, {"contrast": FORM, "frame": (0.5, np.ones((3, 3)))}),
    (ellipsoids.dilute, {"contrast": 2.0, "axes": (1, 1, 1)}, {"fraction": (1.5,)}),
    (ellipsoids.maxwell, {"contrast": INF, "axes": (1, 1, 100)}, {"fraction": (0.5,)}),
    (ellipsoids.penny_cracks, {}, {"density": (0.4,)}),
    (fibres.conductivity, {"kind": "square", "contrast": 2.0, "fraction": 0.3}, {"kind": WORD[:-2], "contrast": FORM, "fraction": (0.0, 0.79), "resistance": FORM, "order": (0,)}),
    (fibres.along, {"contrast": 2.0, "fraction": 0.2}, {"contrast": (*FORM, INF)}),
    (lattice.solve, {"kind": "sc", "contrast": 2.0, "fraction": 0.3}, {"kind": WORD[:-2], "contrast": FORM, "fraction": (0.0, 0.53), "order": (4, 999)}),
    (inclined.laminate, {"conductivities": [1.0, 2.0], "shares": [0.5, 0.5], "normal": (1, 0, 0)}, {"conductivities": ([1.0, -2.0], [1.0, TENSORS[1]]), "shares": ([0.5, 0.6], [1.0]), "normal": (ZERO, (1, 0)), "resistance": FORM}),
    (cracks.discs, {"radius": 0.2}, {"radius": (0.0, 0.5), "height": (0.0,)}),
    (squares.checkerboard, {}, {"contrast": (INF,)}),
    (squares.square_rods, {}, {"contrast": FORM}),
]  # fmt: skip

# What takes no argument of a user, or whatever it is given.
OTHERS = {
    "Field": "made by methods",
    "Samples": "made by methods",
    "Packing": "made by hand without a check; asked for by the gate of packings wherever it is given",
    "Error": "made by the referee",
    "CurveError": "made by the referee",
    "Bracket": "made by the bounds",
    "Tensor": "made by the bounds",
    "cached": "keeps what any function makes",
}


def called(call, arguments):
    made = call(**arguments)
    return list(made) if inspect.isgenerator(made) else made


@pytest.mark.parametrize("row", range(len(TABLE)), ids=lambda row: f"{row}-{TABLE[row][0].__name__}")
def test_nonsense_is_refused_by_name(row):
    call, good, bad = TABLE[row]
    for argument, values in bad.items():
        for value in values:
            told = f"{argument} = {value!r:.80}"
            try:
                made = called(call, good | {argument: value})
            except ValueError as error:
                found = str(error)
                assert argument in found and "must" in found, f"{told}: {found}"
                assert "\n" not in found or isinstance(value, np.ndarray), f"{told}: {found}"
            except Exception as error:
                raise AssertionError(f"{told}: {type(error).__name__}: {error}") from error
            else:
                raise AssertionError(f"{told} was taken: {made!r:.200}")


def test_the_table_is_whole():
    """Every public name of the package, its gallery, packings, statistics and referee, and of the references."""
    rooms = (demheat, packing, statistics, referee)
    public = {name for room in rooms for name in room.__all__}
    public |= {
        name
        for name, made in vars(gallery).items()
        if getattr(made, "__module__", "").startswith(f"{gallery.__name__}.") and name[0] != "_"
    }
    for module in (exact, fem, fft, multipole, bounds, bracket):
        names = [name for name in getattr(module, "__all__", ()) if not name.isupper()]
        assert names, module
        public |= {name for name in names if callable(getattr(module, name))}
    public -= {name for name in statistics.__all__ + demheat.__all__ if name[0].isupper() and name in dir(statistics)}
    assert sorted(public - {call.__name__ for call, _, _ in TABLE} - OTHERS.keys()) == []
    assert sum(len(values) for _, _, bad in TABLE for values in bad.values()) > 1000


def test_unknown_keywords_are_refused():
    for call, good in (
        (solve, {"scene": CELL}),
        (evolve, {"scene": WARMING, "times": [1.0]}),
        (gallery.slab, {}),
        (relax.relax, {"number": 8}),
        (lsa.lsa, {"number": 8}),
        (dispersion.dispersion, {"number": 4}),
    ):
        with pytest.raises(TypeError, match="nonsense"):
            called(call, good | {"nonsense": 1})


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.float16, Fraction, int])
def test_numbers_of_all_kinds_are_taken(kind):
    """What NumPy and Python know as a real number is one, and is kept as a float."""
    one = kind(1)
    assert type(demheat.Calibrated(coordination=one).coordination) is float
    assert demheat.Platonic(gap=one).gap == 1.0 and demheat.Calibrated(factor=one).factor == 1.0
    scene = demheat.Scene(
        (one,) * 3, demheat.Material(one), [demheat.Sphere((one / 2,) * 3, one / 4, OTHER)], gradient=(one, 0, 0)
    )
    assert scene.size == (1.0,) * 3 and scene.inclusions[0].radius == 0.25
    assert gallery.slab(size=[one] * 3, temperatures=(0, one)).walls["y+"] == 1.0
    assert bounds.maxwell(one, 2 * one, one / 2) == pytest.approx(bounds.maxwell(1.0, 2.0, 0.5), rel=1e-15)  # rounding


@pytest.mark.parametrize("kind", [int, np.int64, np.uint8])
def test_whole_numbers_of_all_kinds_are_taken(kind):
    assert gallery.laminate(layers=kind(3)) == gallery.laminate(layers=3)
    assert demheat.Layer(kind(1), 0.1, 0.2, OTHER) == demheat.Layer(1, 0.1, 0.2, OTHER)
    exact.solve(WALLED, points_per_axis=kind(2))
