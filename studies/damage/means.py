"""What the rows lead to: means over draws, beside the theory of random resistors."""

import numpy as np

from demheat.referee import value_error
from studies.damage.cases import NEIGHBOURS
from studies.harness.pick import mean_errors, pick


def theory(removed):
    """Conductivity left of a lattice by the effective medium theory, for the share of links that are gone."""
    return np.maximum(0.0, 1 - np.asarray(removed) / (1 - 2 / NEIGHBOURS))


def left(rows):
    """Mean conductivity over draws of each body and share, a Series by body, number and removed."""
    return rows.groupby(["body", "number", "removed"])["k_ratio"].agg(lambda k: k.mean(skipna=False))


def first_loss(rows):
    """What few links gone take off, over 1.5 of their share, less 1; the worst of all lattices, None without rows."""
    few = left(pick(rows, removed=0.01))
    return float(np.max(np.abs(value_error(1 - few, 1 - theory(0.01))))) if len(few) else None


def beside_theory(rows, most):
    """Largest relative difference to the theory up to a share gone, None without rows."""
    found = left(rows[rows["removed"] <= most])
    gone = found.index.get_level_values("removed")
    return float(np.max(np.abs(value_error(found, theory(gone))))) if len(found) else None


def above_bound(rows):
    """How far means over draws are above 1 - q, of it, at most; None without rows."""
    found = left(rows)
    return float((found / (1 - found.index.get_level_values("removed")) - 1).max()) if len(found) else None


def fall(rows, coarse, fine):
    """Largest error of what discs take away by many particles over that by few; None if a radius lacks one of them."""
    errors = [mean_errors(rows, by="radius", particles=number) for number in (coarse, fine)]
    both = errors[0].index.intersection(errors[1].index)
    return float((errors[1][both] / errors[0][both]).abs().max()) if len(both) else None
