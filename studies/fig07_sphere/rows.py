"""Rows of the paper's network in the sphere: packings, walls and calibrations, see `studies.common.paper_network`.

A cube stands for the sphere where C_t is calibrated, as the sphere has no two opposite walls: of relaxed packings one
of the same radii and volume, of LSA one of as many particles.
"""

from dataclasses import replace

import numpy as np

from demheat import referee
from studies.common import paper_network
from studies.common.sphere_in_time import ACCURACY, CENTER, packing_of, sphere
from studies.harness.cells import cell


def ball(packing, particles, seed):
    """Packing in the sphere, kept in the cache."""
    if packing == "relaxed":
        return packing_of(particles, seed)
    from demheat.packing.cache import grown

    here = {"size": sphere().size, "periodic": False, "domain": "sphere", "seed": seed}
    return grown(particles, pressure=paper_network.PRESSURE, **here)


def cube(packing, made, particles, seed):
    """Packing between walls on which C_t is calibrated, kept in the cache."""
    from demheat.dem.calibration import cube_like

    if packing == "relaxed":
        return cube_like(made)
    return paper_network.packed((1.0, 1.0, 1.0), packing, "center", particles, seed)


def network_row(packing, held, particles, seed, *, times):
    """Errors of the centre in time, by both calibrations.

    All links scale with C_t, so that a march with half of C_t takes twice the time: one serves both calibrations.
    """
    from demheat import dem
    from references import series

    made = ball(packing, particles, seed)
    box = cube(packing, made, particles, seed)
    row = paper_network.calibrated(box, paper_network.unit_law(box, held), held)
    own = row["ct_isothermal"]
    factors = {way: row[f"ct_{way}"] / own for way in paper_network.calibrations(held)}
    reached = sorted({factor * time for factor in factors.values() for time in times})
    law = replace(paper_network.unit_law(made, held), factor=own)
    fields, centre = dem.evolve(sphere(), reached, law=law, packing=made, accuracy=ACCURACY["dem"]), {}
    for time, field in zip(reached, fields, strict=True):
        centre[time] = float(field.temperature_at(CENTER)[0])
    row |= {name: field.stats.get(name) for name in ("steps", "spectral_ratio", "energy_error", "unknowns")}
    exact = np.array([float(each.temperature_at(CENTER)[0]) for each in series.evolve(sphere(), times)])
    for way, factor in factors.items():
        errors = referee.value_error(np.array([centre[factor * time] for time in times]), exact, scale=1.0)
        row |= {f"errors_{way}": cell(errors), f"error_10s_{way}": errors[list(times).index(10.0)]}
        row[f"worst_{way}"] = abs(referee.worst(errors)[1])
    return row
