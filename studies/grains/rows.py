"""One bed of grains as a network, and as a continuum, as a row."""

import math

import numpy as np

from demheat import Material, gallery, grains, referee
from demheat.packing import make_packing
from references import multipole
from references.exact import lattice
from studies.grains import cell
from studies.grains.cases import APART, RATIO, SPHERES
from studies.harness.cost import measured

# Nearest neighbours in edges; sites of a cell.
SITES = {
    "sc": (1.0, [[0.5, 0.5, 0.5]]),
    "bcc": (math.sqrt(0.75), [[0.25, 0.25, 0.25], [0.75, 0.75, 0.75]]),
    "fcc": (math.sqrt(0.5), [[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]]),
}
ALONG = (0.0, 0.0, 1.0)
WIDE = 1.0
# Of exact values: digits of arrays; part of multipoles' beds, far below what the law misses.
DIGITS, ACCURACY = 3, 1e-3


def crystal(kind, apart):
    """Three cells each way of equal grains of radius 1, so far apart between neighbours' surfaces."""
    nearest, sites = SITES[kind]
    edge = (2.0 + apart) / nearest
    corners = np.stack(np.meshgrid(*[np.arange(3.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    centers = (edge * (corners + np.array(sites))).reshape(-1, 3)
    return make_packing(centers, np.ones(len(centers)), np.full(3, 3 * edge), True, {})


def array(kind, gap, contrast):
    """A cubic array in a medium, beside the exact value."""
    bed = crystal(kind, gap)
    fraction = bed.number * 4 / 3 * math.pi / bed.volume
    exact = lattice.conductivity(kind, contrast, fraction, digits=DIGITS)
    return _beside(bed, contrast, exact)


def contact(contact, contrast):
    """Grains of a cubic array that share discs, beside elements on the cell of one: conductances over the radius."""
    # No room is left for gaps but along the load: grains of a row see their cylinder, others a wider lattice.
    apart = 2.0 * math.sqrt(1.0 - contact**2) - 2.0
    solid, medium = (1.0, 0.0) if contrast is None else (contrast, 1.0)
    found, cost = measured(grains.solve, crystal("sc", apart), solid, gradient=ALONG, gap=_gap(contrast, 0.5))
    edge = 2.0 + apart
    exact = cell.conductance(contact, solid, medium)
    row = {"k_ratio": found.conductivity * edge, "exact_ratio": exact}
    if contrast is not None:
        wide = grains.solve(crystal("sc", apart), solid, gradient=ALONG, gap=_gap(contrast, WIDE))
        row |= {"wide_ratio": wide.conductivity * edge}
    return _judged(row) | {"coordination": found.coordination} | cost


def bed(fraction, realisation, contrast):
    """Unlike spheres at random that do not touch, beside multipoles."""
    how = {"fraction": fraction, "gap": APART, "seed": realisation, "ratio": RATIO, "edge": 1.0}
    scene = gallery.dispersion(
        SPHERES, **how, matrix=Material(1.0), inclusion=Material(contrast), axis=2, periodic=True
    )
    exact = multipole.solve(scene, accuracy=ACCURACY).conductivity / scene.matrix.conductivity
    centers, radii = zip(*((each.center, each.radius) for each in scene.inclusions), strict=True)
    return _beside(make_packing(centers, radii, scene.size, True, {}), contrast, exact)


def _gap(contrast, disc):
    return None if contrast is None else grains.Gap(conductivity=1.0, disc=disc)


def _beside(bed, contrast, exact):
    """Row of a bed that does not touch in a medium of conductivity 1."""
    found, cost = measured(grains.solve, bed, contrast, gradient=ALONG, gap=_gap(contrast, 0.5))
    wide = grains.solve(bed, contrast, gradient=ALONG, gap=_gap(contrast, WIDE))
    row = {"k_ratio": found.conductivity, "exact_ratio": float(exact), "wide_ratio": wide.conductivity}
    return _judged(row) | {"links": 2 * len(found.heat) / bed.number} | cost


def _judged(row):
    """Errors, and what is missing in conductivities of the medium."""
    row |= {"error_percent": 100 * referee.value_error(row["k_ratio"], row["exact_ratio"])}
    row |= {"missing": row["exact_ratio"] - row["k_ratio"]}
    if "wide_ratio" in row:
        row |= {"wide_percent": 100 * referee.value_error(row["wide_ratio"], row["exact_ratio"])}
    return row
