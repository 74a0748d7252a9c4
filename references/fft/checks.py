"""What the FFT solvers are asked for, checked before anything is painted."""

from typing import NamedTuple

import numpy as np

from demheat.scene import Scene, check_scene
from demheat.scene.inputs import chosen, finite, whole
from references.fft.rules import LEAST_LINKED, automatic
from references.threads import thread_count

# What else knows a rule: CONTRIBUTING, "Where do I change".
RULES = {"cg": ("auto", "plain", "laminate", "links"), "eyre-milton": ("auto", "plain", "laminate")}
# By which voxels are painted with what their laminates need.
LAMINATED = {"plain": False, "laminate": True, "links": True}
PRECISIONS = {"float64": np.float64, "float32": np.float32}
# Found at contrasts 0.01 to 100: these leave an error of the conductivity, against the grid's own limit, below 1e-10
# (cg: quadratic in the tolerance, so 1e-3 suffices for 1e-6) and 2e-7, of the flux field 1e-5 and 1e-6 of its mean.
TOLERANCES = {"cg": 1e-5, "eyre-milton": 1e-6}


class Knobs(NamedTuple):
    """What the user asks of the scheme, checked; by the names that `stats` has."""

    scheme: str
    rule: str
    precision: str
    tolerance: float
    max_iterations: int
    threads: int


def checked(scheme, rule, precision, tolerance, max_iterations, threads) -> Knobs:
    """Knobs of `solver.solve`, which describes them."""
    chosen("scheme", scheme, RULES)
    if not isinstance(rule, str) or rule not in RULES[scheme]:
        raise ValueError(f"rule = {rule!r}: must be one of {', '.join(RULES[scheme])} for scheme {scheme!r}")
    chosen("precision", precision, PRECISIONS)
    least = float(np.finfo(PRECISIONS[precision]).eps)
    if tolerance is not None:
        valid = f"a number from {least:.2g}, the rounding of {precision}, to below 1"
        finite("tolerance", tolerance, valid, lambda v: least <= v < 1)
    whole("max_iterations", max_iterations, "a whole number >= 1", lambda v: v >= 1)
    tolerance = TOLERANCES[scheme] if tolerance is None else tolerance
    return Knobs(scheme, rule, precision, tolerance, max_iterations, thread_count(threads))


def check_load(scene: Scene) -> None:
    """Raise NotImplementedError if the load is another than those that are solved."""
    check_scene(scene)
    takes = ("exchange", "anisotropy", "image", "resistance", "perfect")
    scene.require("on voxels conductivities are constants", steady=True, takes=takes)
    scene.require(
        "FFT knows a periodic cell and two opposite walls with temperatures, the others insulated; only their "
        "homogeneous problem is inverted by sines and cosines here",
        walls="one isothermal pair",
        takes=takes[1:],
    )


def rule_of(scene: Scene, grid, knobs: Knobs) -> Knobs:
    """Knobs with a rule that suits the scene's voxels."""
    if knobs.rule == "auto":
        knobs = knobs._replace(rule=automatic(knobs.scheme, scene, grid))
    if scene.image is not None:
        knobs = _of_image(scene, knobs)
    if knobs.rule != "laminate" or knobs.scheme == "eyre-milton":
        scene.require(
            "surfaces that resist heat are between corners of voxels; use scheme 'cg' and rule 'laminate'",
            takes=("exchange", "anisotropy", "image"),
        )
    _check_tensors(scene, knobs.scheme, knobs.rule)
    return knobs


def _of_image(scene, knobs):
    """Knobs of an image, none of whose voxels is cut."""
    if knobs.rule != "links":
        return knobs._replace(rule="plain")
    scene.require("links have a harmonic mean; use rule 'plain'", pores=False, takes=("image",))
    return knobs


def _check_tensors(box, scheme, rule):
    """Conductivities that are tensors are for the scalar scheme on voxels."""
    if scheme == "eyre-milton":
        box.require("Eyre and Milton's reference is as good in all directions; use scheme 'cg'", takes=("image",))
    if rule == "links":
        box.require("links along the axes see only its diagonal; use rule 'laminate'", takes=("image",))


def check_grid(box: Scene, rule: str, shape) -> None:
    """Raise ValueError if a grid has too few voxels."""
    if rule != "links" and not box.periodic and shape[0] < 2:
        raise ValueError(f"voxels: {shape[0]} along the load leaves no node between the walls; must be >= 2")
    linked = rule == "links" and box.mean_conductivities.min() > 0
    if linked and min(shape) < LEAST_LINKED and any(not each.flat for each in box.inclusions):
        raise ValueError(
            f"voxels: {min(shape)} along a side are too few for rule 'links' with round inclusions, which may pass "
            f"Voigt's and Reuss's bounds; must be >= {LEAST_LINKED}, or take rule 'laminate'"
        )


def check_scheme(box: Scene, scheme: str, rule: str) -> None:
    """Raise NotImplementedError for pores that leave heat a way, unless they are for the scalar scheme on voxels."""
    if scheme == "eyre-milton":
        box.require(
            "Eyre and Milton's scheme converges like the square root of the contrast, which is infinite; use scheme "
            "'cg'",
            pores=False,
            takes=("image",),
        )
    if rule == "links":
        box.require("links have a harmonic mean; use rule 'plain'", pores=False, takes=("image",))
