"""What is asked of `solve` and `evolve`, refused before any heavy work where it makes no sense."""

import numpy as np

from demheat.conduction.sources import check_sources
from demheat.network.calibrated import POLICIES, WALL_RULES
from demheat.network.interface import check_rule
from demheat.packing.interfaces import surfaces_of
from demheat.packing.relax import FEWEST

LAWS = ("laguerre", "calibrated", "platonic")
# Choices that only the laws of contacts have, and their defaults.
CONTACT = {"poor": "nearest", "wall": "center", "coordination": None, "gap": None}


def check_steady(scene, *, law, conforming, interface, contact, packing, particles, allow_few):
    """Raise unless `solve` can do what is asked; whether twins are wanted at interfaces.

    Raises
    ------
    ValueError, NotImplementedError
    """
    wanted = _check_law(law, _wanted(conforming, law == "laguerre"), interface, contact)
    scene.require(steady=True)
    if wanted:
        # Refuses inclusions of shapes that are not known.
        surfaces_of(scene)
    _check_walls(scene, law, contact["wall"])
    _check_packing(scene, packing, particles, allow_few)
    return wanted


def check_transient(scene, stop, *, law, conforming, interface, contact, packing, particles, allow_few):
    """Raise unless `evolve` can do what is asked until a time in seconds; whether twins are wanted at interfaces.

    Raises
    ------
    ValueError, NotImplementedError
    """
    by_default = law == "laguerre" and bool(scene.inclusions)
    wanted = _check_law(law, _wanted(conforming, by_default), interface, contact)
    scene.require(steady=False)
    if wanted:
        scene.require("no conforming packing is known there; pass conforming=False", domain="box")
        surfaces_of(scene)
    if contact["wall"] == "surface":
        scene.require("wall 'surface' knows flat walls only; pass wall='center', or law 'laguerre'", walls="flat")
    _check_walls(scene, law, contact["wall"])
    _check_packing(scene, packing, particles, allow_few)
    check_sources(scene, stop)
    return wanted


def _wanted(conforming, by_default):
    if conforming is None:
        return by_default
    _check_flag("conforming", conforming, "True, False or None")
    return bool(conforming)


def _check_flag(name, value, valid):
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} = {value!r}: must be {valid}")


def _check_law(law, conforming, interface, contact):
    if law not in LAWS:
        raise ValueError(f"law = {law!r}: must be one of {', '.join(LAWS)}")
    check_rule(interface)
    _check_contact(law, **contact)
    if conforming and law != "laguerre":
        raise ValueError(
            f"conforming = True with law = {law!r}: twins need not touch; must be False, or law 'laguerre'"
        )
    return conforming


def _check_contact(law, *, poor, wall, coordination, gap):
    if coordination is not None and not _finite_number(coordination, 0.0):
        raise ValueError(f"coordination = {coordination!r}: must be a finite number > 0")
    if gap is not None and not _finite_number(gap, -1.0):
        raise ValueError(f"gap = {gap!r}: must be a finite part of r_i + r_j > -1")
    if gap is not None and coordination is not None:
        raise ValueError(f"gap = {gap!r}, coordination = {coordination!r}: one gives the other; pass one of them")
    for name, value, valid in (("poor", poor, POLICIES), ("wall", wall, WALL_RULES)):
        if value not in valid:
            raise ValueError(f"{name} = {value!r}: must be one of {', '.join(valid)}")
    given = {"poor": poor, "wall": wall, "coordination": coordination, "gap": gap}
    odd = [f"{name} = {value!r}" for name, value in given.items() if value != CONTACT[name]]
    if law == "laguerre" and odd:
        raise ValueError(
            f"{', '.join(odd)} with law = 'laguerre': only the laws 'calibrated' and 'platonic' have these choices"
        )


def _finite_number(value, low):
    return isinstance(value, int | float) and not isinstance(value, bool) and low < value < float("inf")


def _check_walls(scene, law, wall):
    if law != "laguerre" and wall == "center":
        scene.require(
            f"law {law!r} with wall 'center' holds the centres of the particles at a wall at its temperature: where "
            "two held walls meet, one particle would join them; use wall 'surface'",
            walls="isothermal ones apart",
        )


def _check_packing(scene, packing, particles, allow_few):
    _check_flag("allow_few", allow_few, "True or False")
    if packing is None:
        if not isinstance(particles, int | np.integer) or isinstance(particles, bool) or particles < 1:
            raise ValueError(f"particles = {particles!r}: must be an integer >= 1")
        if particles < FEWEST and not allow_few:
            raise ValueError(f"particles = {particles!r}: fewer than {FEWEST}; pass allow_few=True if you mean it")
        return
    like = packing.domain == scene.domain and set(packing.periodic.tolist()) == {scene.periodic}
    if not (like and np.allclose(packing.size, scene.size, rtol=1e-9)):
        kind = "periodic" if scene.periodic else "walled"
        raise ValueError(
            f"packing of size {packing.size.tolist()} in a {packing.domain}, periodic {packing.periodic.tolist()}: "
            f"must be {kind}, in the scene's {scene.domain} of size {scene.size}"
        )
