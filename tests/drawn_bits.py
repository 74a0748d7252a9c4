"""Digests of packings and scenes that are drawn by seed, as JSON. Run as a script, on one or another processor."""

import hashlib
import json
import sys

import numpy as np

from demheat import gallery
from demheat.packing import contacts
from demheat.packing.lsa import lsa
from demheat.packing.radii import Bidisperse, Lognormal
from demheat.packing.relax import relax


def digest(*arrays):
    return hashlib.sha256(b"".join(np.ascontiguousarray(each).tobytes() for each in arrays)).hexdigest()[:16]


def of_packing(packing):
    return digest(packing.centers, packing.radii)


def of_scene(scene):
    return digest(*([*each.center, each.radius] for each in scene.inclusions))


def drawn():
    """Each way to draw spheres, few of them."""
    few = {"allow_few": True, "seed": 3}
    relaxed = relax(300, seed=1)
    yield "relaxed", of_packing(relaxed)
    yield "contacts", digest(*contacts(relaxed)[:2])
    walls = {"periodic": False, "size": (1.0, 2.0, 1.0)}
    yield "relaxed between walls", of_packing(relax(64, radii=Lognormal(0.4), **walls, **few))
    yield "relaxed in a cylinder", of_packing(relax(64, domain="cylinder-y", **walls, **few))
    yield "grown", of_packing(lsa(120, phi=0.55, radii=Bidisperse(4.0, 0.1), seed=2))
    yield "grown between walls", of_packing(lsa(60, phi=0.4, **walls, **few))
    yield "dispersion", of_scene(gallery.dispersion(24, fraction=0.3, ratio=3.0, gap=0.05))
    yield "one by one", of_scene(gallery.random_dispersion(fraction=0.2))
    yield "one by one between walls", of_scene(gallery.random_dispersion(fraction=0.15, periodic=False, seed=1))


if __name__ == "__main__":
    json.dump(dict(drawn()), sys.stdout)
