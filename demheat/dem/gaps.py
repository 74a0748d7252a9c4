"""How far an answer may be off where bodies touch, or nearly: facets cross the gaps in which no twins fit.

Between bad conductors they carry too little, and fewer particles hardly tell. The truth lies between the answer and
that of the same particles where what lies in the gaps conducts instead. Between good ones they carry what the gaps let
pass, which is known to a part: the same particles with so much less of it tell what that is worth, either way.
"""

import math
from collections.abc import Callable

import numpy as np

from demheat.error import Estimate, conductivity_of, quietly
from demheat.field import Field
from demheat.network.bridges import bad, filled, loosened, needed


def reaching(estimate: Callable, field: Field, *, answer: Callable) -> Estimate:
    """An estimate that reaches to what is so if gaps without twins are filled, where that matters."""
    found = estimate(field)
    if not needed(field.stats["packing"], field.scene):
        return found
    other = quietly(lambda change: answer(change=change), _changed)
    ends = [k for k in (conductivity_of(field), conductivity_of(other)) if math.isfinite(k)]
    # Between bad conductors the truth is on the one side of the answer; what a gap lets pass may be more, or less.
    apart = 0.0 if bad(field.scene) else max(ends) - min(ends)
    flux = float(np.linalg.norm(field.mean_flux - other.mean_flux))
    return found._replace(
        lower=min([found.lower - apart, *ends]),
        upper=max([found.upper + apart, *ends]),
        flux=found.flux + flux,
        temperature=max(found.temperature, _apart(field, other)),
    )


def _changed(network, scene):
    return loosened(filled(network, scene), scene)


def _apart(field, other):
    """Root mean square of what temperatures of the same particles differ by, without their mean in a periodic cell."""
    one, two = field.samples, other.samples
    differ = one.temperature - two.temperature
    kept = np.isfinite(differ)
    differ, weight = differ[kept], one.volumes[kept]
    if field.scene.periodic:
        differ = differ - np.average(differ, weights=weight)
    return float(np.sqrt(np.average(differ**2, weights=weight)))
