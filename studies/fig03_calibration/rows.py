"""Packings and homogeneous solves of the calibration: what one C_t costs and says."""

import numpy as np

from demheat.dem.calibration import calibration
from demheat.dem.networks import network_of
from demheat.laws import Calibrated
from demheat.packing.cache import grown, relaxed
from demheat.packing.domain import replicate
from demheat.packing.neighbours import contacts
from demheat.packing.radii import Gaussian
from demheat.packing.statistics import coordination
from demheat.scene import Material, Scene

# A flat wall keeps the bulk as many mean radii away on average (relaxed packings, found at 3e3 to 1e5 particles and
# spread 0.3, +-0.03): the packing fraction over the whole sample is lower by as much, that of the bulk as asked for.
DEPLETED = 0.27
# Reduced pressure at which the algorithm of Lubachevsky and Stillinger stops, with walls or without: phi = 0.641 in a
# periodic cell, and the same state of the bulk between walls.
PRESSURE = 120.0
# Which axes are periodic: walls everywhere; along the load (y) only; nowhere.
PERIODIC = {"flux": False, "isothermal": False, "across": (True, False, True), "periodic": True}


def packed(loading, domain, packing, particles, seed, *, spread=0.3, replicas=1):
    """Packing of unit size for a load, kept in the cache; replicas is the number of repeats along each axis."""
    if replicas > 1:
        whole = packed(loading, domain, packing, particles // replicas**3, seed, spread=spread)
        return replicate(whole, (replicas, replicas, replicas)).scaled(1 / replicas)
    kind = {"periodic": PERIODIC[loading], "domain": "box" if domain == "cube" else "cylinder-y", "seed": seed}
    radii = Gaussian(spread)
    if packing == "lsa":
        return grown(particles, pressure=PRESSURE, radii=radii, **kind)
    # Equal spheres jam at 0.64.
    phi = _bulk_to_whole(0.64 if spread > 0.2 else 0.63, particles, kind, radii)
    return relaxed(particles, phi=phi, radii=radii, **kind)


def _bulk_to_whole(phi, particles, kind, radii):
    """Packing fraction of the whole sample for one of the bulk."""
    cube = radii.draw(100_000, np.random.default_rng(0)) ** 3
    volume = 1.0 if kind["domain"] == "box" else np.pi / 4
    radius = np.cbrt(phi * volume / (particles * 4 / 3 * np.pi * cube.mean()))
    # Between two walls a length 1 - 2 depth is left; across a cylinder of diameter 1 the same, twice.
    walls = 3 - int(np.sum(np.broadcast_to(kind["periodic"], 3)))
    return float(phi * (1 - 2 * DEPLETED * radius) ** walls)


def calibrated(packing, loading, *, margin=None, wanted=7.5, count="all", **choices):
    """C_t of a packing under a load, with what it depends on."""
    as_papers = loading in ("flux", "isothermal")
    choices = {"wall": "center" if as_papers else "surface"} | choices
    additive = choices.get("additive", False)
    margin = (0.0 if as_papers else 4.0) if margin is None else margin
    load = {"gradient": (0, 1, 0)} if loading == "periodic" else {"walls": {"y-": 0.0, "y+": 1.0}}
    scene = Scene(size=tuple(packing.size), matrix=Material(1.0), **load)
    target = wanted
    for _ in range(4 if count == "rest" else 1):
        links = contacts(packing, coordination=target, margin=margin, additive=additive)
        law = Calibrated(gap=links[2], factor=1.0, **choices)
        network = network_of(scene, packing, law)
        left = len(network.radii)
        reached = len(network.indices) / left
        target += wanted - reached
    found, gap = coordination(packing, *links[:2]), links[2]
    report = {"gap": gap, "links": found.mean, "least": found.least, "under_2": found.under_2, "under_4": found.under_4}
    report |= {"islands": found.components, "phi": packing.phi, "linked": reached, "left": left}
    del links
    how = "flux" if loading == "flux" else "isothermal"
    # Replicas of a periodic cell all have the same temperatures: conjugate gradients need no more steps than for one.
    solver = "cg" if packing.provenance.get("algorithm") == "replicate" else "auto"
    ct = calibration(network, scene, loading=how, solver=solver)
    return {"ct": float(ct)} | affine(packing, network) | report


def affine(packing, network):
    """C_t under a linear temperature field.

    A linear field is a trial field of the periodic cell: the conductivity with C_t = 1 is at most
    sum over links of S d cos^2 / V, the angle being that to the load, hence C_t at least its inverse (`bound`). For
    isotropic links that touch, d = 2 R_m, and the sum is (N Z / 2)(1/3) 2 pi <R_m^3> / V with N / V = phi / <4/3 pi
    R^3>: C_t >= 4 <R^3> / (Z phi <R_m^3>) (`formula`), with <R^3> over particles and <R_m^3> over links.
    """
    rest = packing._replace(centers=network.centers, radii=network.radii)
    here = np.repeat(rest.radii, np.diff(network.indptr))
    there = rest.radii[network.indices]
    length = network.distance * (here + there) / here
    y = rest.centers[:, 1]
    step = y[network.indices] - np.repeat(y, np.diff(network.indptr))
    step -= np.where(rest.periodic[1], np.round(step / rest.size[1]) * rest.size[1], 0.0)
    slope = 0.5 * (network.area / length) @ step**2 / rest.volume
    z, cubes = len(here) / rest.number, np.mean((network.area / np.pi) ** 1.5)
    return {"bound": 1 / slope, "formula": 4 * np.mean(rest.radii**3) / (z * rest.phi * cubes)}
