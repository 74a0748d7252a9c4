"""Rows of the search: what one set of spread, links and mean radius gives on a few packings."""

import numpy as np

from demheat import referee
from demheat.dem import solve
from demheat.dem.calibration import calibration
from demheat.dem.networks import network_of
from demheat.gallery import sphere_in_cube
from demheat.laws import Calibrated
from demheat.packing.cache import grown
from demheat.packing.neighbours import contacts
from demheat.packing.radii import Gaussian
from demheat.packing.statistics import coordination
from demheat.sampling.halo import halo_flux
from studies.common.block import LENGTH, contact_field, scene_of
from studies.harness.methods import MATRIX, THIRD, exact_ratio

NUMBER, SEEDS = 3_000, (0, 1, 2)
# Reduced pressure at which spheres stop growing: phi = .64 with a spread of .3, as in `fig03_calibration`.
PRESSURE = 120.0
CONTRASTS, RATIOS = (0.01, 0.1, 10.0, 100.0), (4.0, 11.0)


def packed(spread, seed, *, periodic):
    """Hard spheres in the block, kept in the cache."""
    size = (LENGTH,) * 3
    return grown(NUMBER, size=size, pressure=PRESSURE, radii=Gaussian(spread), periodic=periodic, seed=seed)


def set_row(spread, links, mean):
    """Means over packings, and of C_t their standard deviation."""
    found = [of_one(spread, links, mean, seed) for seed in SEEDS]
    row = {name: float(np.mean([one[name] for one in found])) for name in found[0]}
    return row | {f"{name}_sd": float(np.std([one[name] for one in found], ddof=1)) for name in ("ct_cell", "ct_block")}


def of_one(spread, links, mean, seed):
    """The same of one pair of packings."""
    cell, block = (packed(spread, seed, periodic=periodic) for periodic in (True, False))
    row = {"phi": cell.phi}
    row |= _in_cell(cell, links, mean)
    return row | _in_block(block, links, mean)


def _law(packing, links, mean, **more):
    """The paper's law with the gap of so many links, and the rows of links."""
    found = contacts(packing, coordination=links, margin=0.0)
    return Calibrated(gap=found[2], mean=mean, **more), found


def _in_cell(packing, links, mean):
    """C_t without walls, scatter of the flux along the load in halos, links."""
    # Of conductivity 1, as `calibration` wants it.
    scene = scene_of("periodic", 1.0)
    law, (indptr, indices, gap) = _law(packing, links, mean, factor=1.0)
    row = {"gap": gap, "under_2": coordination(packing, indptr, indices).under_2}
    row["ct_cell"] = calibration(network_of(scene, packing, law), scene)
    # C_t scales all fluxes alike.
    field = contact_field(scene, packing, law, "half")
    fluxes = {0.0: field.samples.flux} | {ratio: halo_flux(field, ratio=ratio) for ratio in RATIOS}
    for ratio, flux in fluxes.items():
        for name, weights in (("cov", None), ("cov_volume", field.samples.volumes)):
            row[f"{name}_{ratio:g}"] = 100 * abs(referee.variation(flux[:, 1], weights))
    return row


def _in_block(packing, links, mean):
    """C_t by the paper's load, and with it the errors of one sphere, %, by contrast."""
    scene = scene_of("held", 1.0)
    law, (_, _, gap) = _law(packing, links, mean, factor=1.0)
    ct = calibration(network_of(scene, packing, law), scene, loading="flux")
    row, law = {"ct_block": ct}, Calibrated(gap=gap, mean=mean, factor=ct)
    for contrast in CONTRASTS:
        field = solve(sphere_in_cube(contrast), packing=packing, law=law)
        exact = MATRIX * exact_ratio(THIRD, contrast)
        row[f"error_{contrast:g}"] = 100 * referee.conductivity_error(field, exact)
    return row
