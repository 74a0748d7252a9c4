"""Rows of the study of tuning: conductivities of unseen scenes with one constant changed; where errors come from."""

import warnings

import numpy as np

from demheat import Laguerre, solve
from demheat.packing.cache import relaxed
from studies.harness.cells import cell
from studies.tuning.cases import OLD
from studies.tuning.constants import CLOSE, constant_set
from studies.tuning.scenes import reference, scene_of

DIGITS = ".10g"


def references(family, seeds):
    """Conductivities by a witness."""
    known, doubts = zip(*(reference(family, seed) for seed in seeds), strict=True)
    return {"k": cell(known, DIGITS), "doubt": cell(doubts, ".2g")}


def varied(families, seeds, constant, factor, particles):
    """Conductivities by the DEM with one constant changed; packings have the scenes' seeds."""
    row, unknowns = {}, []
    law = Laguerre(gap_spacing=factor * CLOSE) if constant == "GAP_SPACING" else Laguerre()
    with constant_set(constant, factor), warnings.catch_warnings():
        # Gaps that twins do not fit into are counted.
        warnings.simplefilter("ignore", UserWarning)
        left_out = 0
        for family in families:
            fields = [_solved(scene_of(family, seed), law, particles, seed, constant in OLD) for seed in seeds]
            row[family] = cell([field.conductivity for field in fields], DIGITS)
            unknowns += [field.stats["unknowns"] for field in fields]
            left_out += sum(field.stats["packing"]["pairs_left_out"] for field in fields)
    return row | {"unknowns": float(np.mean(unknowns)), "left_out": left_out}


def _solved(scene, law, particles, seed, on_relaxed):
    packing = relaxed(particles, size=scene.size, periodic=scene.periodic, seed=seed) if on_relaxed else None
    return solve(scene, law=law, particles=particles, seed=seed, packing=packing)
