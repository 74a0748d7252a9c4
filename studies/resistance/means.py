"""What the rows of silica in epoxy lead to: the Kapitza length that a fall of the conductivity asks for."""

import numpy as np
from scipy.optimize import brentq

from demheat.gallery import EPOXY, SILICA
from demheat.referee import value_error
from references.bounds import maxwell
from studies.harness.pick import pick


def curve(rows, fraction):
    """Mean conductivity over the matrix's at each Kapitza length, a Series; those of one arrangement weigh the same."""
    return pick(rows, fraction=fraction).groupby("kapitza")["k_ratio"].agg(lambda k: k.mean(skipna=False))


def lowest(rows):
    """Least fall from one Kapitza length to the next over all fractions; None without two lengths."""
    falls = [-np.diff(curve(rows, fraction)) for fraction in rows["fraction"].unique()]
    falls = np.concatenate([*falls, np.empty(0)])
    return float(falls.min()) if len(falls) else None


def explaining(rows, fraction, fall):
    """Kapitza length over the radius at which the conductivity is so much less; None if rows do not reach it.

    By the inverse of 1 - k/k(0), which is nearly a line in the inverse of the length, between the two rows beside it.
    """
    found = curve(rows, fraction)
    if 0.0 not in found.index or len(found) < 3:
        return None
    lost = -value_error(found, found[0.0]).drop(0.0)
    if not lost.iloc[0] <= fall <= lost.iloc[-1]:
        return None
    # Both ascend with the inverse length.
    inverse = np.interp(1 / fall, 1 / lost.to_numpy()[::-1], 1 / lost.index.to_numpy()[::-1])
    return float(1 / inverse)


def foreseen(fraction, fall):
    """The same by Hasselman and Johnson's formula: Maxwell's, with s/(1 + s l) for the contrast s."""

    def lost(length):
        return -value_error(conductivity(fraction, length), conductivity(fraction, 0.0)) - fall

    return float(brentq(lost, 0.0, 10.0))


def conductivity(fraction, length):
    """Conductivity over the matrix's by Hasselman and Johnson (J. Compos. Mater. 21 (1987) 508)."""
    contrast = SILICA.conductivity / EPOXY.conductivity
    return float(maxwell(1.0, contrast / (1 + contrast * length), fraction))


def radius_of(length, resistance):
    """Radius, m, at which a resistance in m2 K/W is a Kapitza length over the radius."""
    return resistance * EPOXY.conductivity / length
