"""Packings by our Lubachevsky-Stillinger algorithm and by others, and what they are like: rows of `packings`."""

import math

import numpy as np
from scipy.spatial import cKDTree

from demheat import referee
from demheat.packing import statistics
from demheat.packing.base import make_packing
from demheat.packing.lsa import lsa
from demheat.packing.neighbours import contacts
from demheat.packing.radii import Bidisperse, Gaussian
from demheat.packing.relax import relax
from demheat.scene import ROUND_AXES
from studies.harness.cells import cell
from studies.harness.cost import measured

# Surface distances, as parts of r_i + r_j, at which contacts are counted.
GAPS = np.logspace(-6, -1, 16)
# Contacts that hold a jammed packing: closed to some 1 / pressure, but for those that growth to the end leaves open.
CONTACT_GAP = 1e-4
STRAIN = 0.03


def packed(maker, particles, radii, seed, *, growth=0.02, pressure=None, phi=None, domain="box"):
    """Make a packing of a unit cube or what is inscribed in it, by one of three programs, and say what that cost."""
    laws = {"equal": Gaussian(0.0), "gaussian": Gaussian(0.3), "ten": Bidisperse(10.0, 0.01)}
    drawn = laws[radii].draw(particles, np.random.default_rng([seed, 2]))
    if maker == "spheropack":
        return _spheropack(drawn, seed, growth, pressure)
    where = {"periodic": domain == "box", "domain": "box" if domain == "walls" else domain}
    if maker == "relax":
        packing, cost = measured(relax, particles, radii=drawn, seed=seed, phi=phi, **where)
        return packing, {**cost, "mean_overlap": packing.provenance["mean_overlap"]}
    packing, cost = measured(lsa, particles, radii=drawn, seed=seed, growth=growth, pressure=pressure, phi=phi, **where)
    reached = packing.provenance
    row = _counted(cost, reached["pressure"], reached["collisions"], particles)
    return packing, row | {"shrunk": reached["shrunk"]}


def _spheropack(drawn, seed, growth, pressure):
    """The same spheres by spheropack (C++), from points as it always begins."""
    try:
        import spheropack
    except ImportError as error:
        raise NotImplementedError("spheropack is not installed; install it and run with --force") from error
    stop = [spheropack.stop.Pressure(pressure)]
    found, cost = measured(
        spheropack.pack, radii=drawn, density="max", growth_rate=growth, stop=stop, seed=seed, strict=True
    )
    packing = make_packing(found.positions, found.radii, (1.0, 1.0, 1.0), True, {"algorithm": "spheropack"})
    row = _counted(cost, found.reduced_pressure, found.n_collisions / len(drawn), len(drawn))
    return packing, row | {"peer_version": spheropack.__version__}


def _counted(cost, pressure, collisions, particles):
    each = 1e6 * cost["cpu_s"] / (collisions * particles)
    return {**cost, "reached_pressure": pressure, "collisions": collisions, "us_per_collision": each}


def described(packing, row, *, curves):
    """What a packing is like: density, overlap, contacts, isotropy; with curves for the figure if asked for."""
    margin = 0.0 if packing.periodic.all() else 5.0
    found = {"phi_reached": packing.phi, "phi_core": statistics.packing_fraction(packing, margin=margin)}
    found |= {"overlap": overlap(packing), "bytes_per_sphere": row["peak_mib"] * 2**20 / packing.number}
    found |= {"z_of_gap": cell(_z_of_gap(packing))}
    touching = contacts(packing, gap=CONTACT_GAP)[:2]
    held = statistics.backbone(packing, *touching, gap=CONTACT_GAP)
    found |= {"rattlers": float(held.rattler.mean()), "backbone_z": held.coordination}
    indptr, indices, gap = contacts(packing, coordination=7.5, margin=margin)
    links = statistics.coordination(packing, indptr, indices, margin=margin)
    found |= {"gap_7.5": gap, "under_2": links.under_2, "under_4": links.under_4, "islands": links.components}
    fabric = statistics.fabric(packing, indptr, indices, margin=margin)
    found |= {"fabric_sd": fabric.deviation, "fourth_sd": fabric.fourth_deviation}
    # The same links in a packing stretched along x: what an anisotropic one would show.
    stretch = np.array([1.0 + STRAIN, 1.0, 1.0])
    strained = packing._replace(centers=packing.centers * stretch, size=packing.size * stretch, domain="box")
    found |= {"strained_sd": statistics.fabric(strained, indptr, indices).deviation}
    return found | (_curves(packing, indptr, indices) if curves else {})


def overlap(packing):
    """Largest overlap of two spheres, or of a sphere and a wall, over the mean diameter; 0 if there is none.

    By SciPy's k-d tree, which no packing here was made with.
    """
    x, r = packing.centers, packing.radii
    i, j = cKDTree(x, boxsize=np.where(packing.periodic, packing.size, 0.0)).query_pairs(
        2 * r.max(), output_type="ndarray"
    ).T  # fmt: skip
    offsets = x[i] - x[j]
    offsets -= np.where(packing.periodic, packing.size * np.rint(offsets / packing.size), 0.0)
    most = np.max(r[i] + r[j] - np.linalg.norm(offsets, axis=1), initial=0.0)
    axes = list(ROUND_AXES[packing.domain])
    for axis in set(range(3)) - set(axes):
        if not packing.periodic[axis]:
            most = max(most, np.max(r - x[:, axis]), np.max(x[:, axis] + r - packing.size[axis]))
    if axes:
        away = np.linalg.norm(x[:, axes] - packing.size[axes] / 2, axis=1)
        most = max(most, np.max(away + r) - packing.size[axes[0]] / 2)
    return float(most / (2 * r.mean()))


def _z_of_gap(packing):
    """Mean number of neighbours within each of GAPS."""
    indptr, indices, _ = contacts(packing, gap=float(GAPS[-1]))
    rows = np.repeat(np.arange(packing.number), np.diff(indptr))
    offsets = packing.centers[indices] - packing.centers[rows]
    offsets -= np.where(packing.periodic, packing.size * np.rint(offsets / packing.size), 0.0)
    gaps = np.linalg.norm(offsets, axis=1) / (packing.radii[rows] + packing.radii[indices]) - 1
    return np.searchsorted(np.sort(gaps), GAPS, side="right") / packing.number


def _curves(packing, indptr, indices):
    g = statistics.radial_distribution(packing, r_max=4.0, bins=100)
    scaled = statistics.radial_distribution(packing, r_max=2.0, bins=100, scaled=True)
    s2 = statistics.two_point(packing, r_max=3.0, points=61)
    polar = statistics.directions(packing, indptr, indices)
    worst, _ = referee.worst(referee.value_error(s2.slope, s2.exact_slope))
    found = {"r": cell(g.r), "g": cell(g.g), "scaled_r": cell(scaled.r), "scaled_g": cell(scaled.g)}
    found |= {f"s2_{k}": cell(s2.s2[k]) for k in range(3)}
    found |= {
        "s2_r": cell(s2.r),
        "s2_error": float(s2.error[:, 1:].mean()),
        "s2_spread": float(np.ptp(s2.s2, 0).max()),
    }
    found |= {
        "slope_exact": s2.exact_slope,
        "slope_mean": float(s2.slope.mean()),
        "slope_worst": float(s2.slope[worst]),
    }
    found |= {"slope_error": float(math.sqrt(np.sum(s2.slope_error**2)) / len(s2.slope))}
    names = {f"polar_{axis}": cell(polar.density[k]) for k, axis in enumerate("xyz")}
    return found | names | {"polar_error": float(polar.error.max()), "polar_angle": cell(polar.angles)}
