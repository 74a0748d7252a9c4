"""How far an answer may be off where bodies touch, or nearly: facets cross the gaps in which no twins fit.

Between good conductors fewer particles hardly tell: what crosses goes on growing with their contrast. The truth lies
between the answer and that of the same particles where what lies in the gaps conducts instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from demheat.error import Estimate, conductivity_of, quietly
from demheat.field import Field
from demheat.network.bridges import filled, matter


def reaching(estimate: Callable, field: Field, *, answer: Callable) -> Estimate:
    """An estimate that reaches to what is so if gaps without twins are filled, where that matters."""
    found = estimate(field)
    if not (left_out(field) and matter(field.scene)):
        return found
    other = quietly(lambda change: answer(change=change), filled)
    ends = [k for k in (conductivity_of(field), conductivity_of(other)) if math.isfinite(k)]
    flux = float(np.linalg.norm(field.mean_flux - other.mean_flux))
    return found._replace(
        lower=min([found.lower, *ends]),
        upper=max([found.upper, *ends]),
        flux=max(found.flux, flux),
        temperature=max(found.temperature, _apart(field, other)),
    )


def left_out(field) -> bool:
    """Whether there are gaps without twins."""
    packing = field.stats["packing"]
    return packing.get("of", packing).get("pairsleft_out", 0) > 0


def _apart(field, other):
    """Root mean square of what temperatures of the same particles differ by, without their mean in a periodic cell."""
    one, two = field.samples, other.samples
    differ = one.temperature - two.temperature
    kept = np.isfinite(differ)
    differ, weight = differ[kept], one.volumes[kept]
    if field.scene.periodic:
        differ = differ - np.average(differ, weights=weight)
    return float(np.sqrt(np.average(differ**2, weights=weight)))
