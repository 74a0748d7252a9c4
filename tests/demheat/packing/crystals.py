"""Packings whose statistics are known: crystals and ideal gases."""

from itertools import product

import numpy as np

from demheat.packing.base import make_packing
from demheat.packing.neighbours import contacts
from demheat.scene.bodies import ROUND_AXES

# Crystals touch to rounding, 1e-15; their second neighbours are 1.41 away.
CONTACT_GAP = 1e-6


def crystal(cells, basis, radius, *, periodic=True, size=None):
    """Equal touching spheres on a lattice of unit cubes; radius in cubes."""
    size = np.full(3, cells) if size is None else size
    corners = np.array(list(product(range(cells), repeat=3)))
    centers = (corners[:, None] + np.array(basis)).reshape(-1, 3)
    return make_packing(centers, np.full(len(centers), radius), size, periodic, {})


def simple_cubic(cells=6, **keywords):
    return crystal(cells, [(0.5, 0.5, 0.5)], 0.5, **keywords)


def face_centred(cells=4):
    basis = np.array([(0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0)]) + 0.25
    return crystal(cells, basis, np.sqrt(2) / 4)


def random_packing(seed, number=400, *, periodic=True, domain="box", size=(1.0, 1.0, 1.0), radius=0.05):
    """Random points and radii of up to threefold size: an ideal gas."""
    rng, radii = np.random.default_rng(seed), None
    size, axes = np.array(size), list(ROUND_AXES[domain])
    centers = rng.random((4 * number, 3)) * size
    inside = np.linalg.norm((centers - size / 2)[:, axes], axis=1) <= (size[axes[0]] / 2 if axes else 1.0)
    radii = radius * rng.uniform(0.5, 1.5, number)
    return make_packing(centers[inside][:number], radii, size, periodic, {}, domain=domain)


def touching(packing):
    return contacts(packing, gap=CONTACT_GAP)[:2]


def distances(packing):
    """All nearest-image distances, (n, n) float array; infinite from a particle to itself."""
    offsets = packing.centers[None] - packing.centers[:, None]
    offsets -= np.where(packing.periodic, packing.size * np.rint(offsets / packing.size), 0.0)
    result = np.sqrt((offsets**2).sum(axis=-1))
    np.fill_diagonal(result, np.inf)
    return result
