"""One solve of a damaged body, as a row."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from demheat import Material, Scene, gallery, referee
from demheat.damage import Disc, solve
from demheat.damage import debonded as come_off
from demheat.packing.base import make_packing
from references import multipole
from references.exact.cracks import discs
from studies.damage.cases import FRACTION, SPHERES
from studies.harness import methods
from studies.harness.cost import measured

# Of the draw of spheres.
SEED = 1
CELL = Scene((1.0, 1.0, 1.0), Material(1.0), gradient=(0.0, 0.0, 1.0))
# Along the diagonal all links of a lattice carry the same heat: one that is gone takes away as much as any other.
DIAGONAL = replace(CELL, gradient=(1.0, 1.0, 1.0))
NAMES = ("unknowns", "iterations", "residual", "packing_s", "solve_s")


def damaged(share):
    """Spheres a share of which has come off."""
    return come_off(gallery.random_dispersion(SPHERES, fraction=FRACTION, gap=0.1), share, seed=SEED)


@lru_cache(maxsize=8)
def _exact(share):
    return multipole.solve(damaged(share)).conductivity


def debonded(share, *, method, **knobs):
    """Spheres that have come off, beside multipoles."""
    scene, sure = damaged(share), _exact(share)
    field, cost = measured(methods.load(method).solve, scene, **knobs)
    row = {"k_ratio": field.conductivity / scene.matrix.conductivity}
    row["exact_ratio"] = sure / scene.matrix.conductivity
    row["error_percent"] = 100 * referee.conductivity_error(field, sure)
    return row | {name: field.stats.get(name) for name in NAMES} | cost


def cracks(radius, *, method, **knobs):
    """A disc in the middle of a cell, across the load, beside the exact value."""
    sure = discs(radius).conductivity
    field, cost = measured(solve, CELL, cracks=[Disc((0.5, 0.5, 0.5), radius, (0.0, 0.0, 1.0))], **knobs)
    row = {"k_ratio": field.conductivity, "exact_ratio": sure}
    row["error_percent"] = 100 * referee.conductivity_error(field, sure)
    return row | {name: field.stats.get(name) for name in NAMES} | cost


def links(body, number, removed, draw, *, method, **knobs):
    """A lattice or a packing without some of its links."""
    where = {"packing": lattice(number)} if body == "lattice" else {"particles": number}
    field, cost = measured(solve, DIAGONAL, removed=removed, draw=draw, **where, **knobs)
    return {"k_ratio": field.conductivity} | {name: field.stats.get(name) for name in NAMES} | cost


def lattice(cells):
    """A periodic packing on a simple cubic lattice, whose network is one of equal links."""
    step = 1 / cells
    places = np.stack(np.meshgrid(*3 * [np.arange(cells)], indexing="ij"), axis=-1).reshape(-1, 3) + 0.5
    return make_packing(step * places, np.full(cells**3, step / 2), CELL.size, (True,) * 3, {})
