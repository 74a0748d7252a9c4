"""The referee: every error of temperature, flux or conductivity is defined here; no method imports it.

Conventions: errors of conductivity are relative to the reference; of temperature relative to the span that the load
imposes; of flux relative to the magnitude of the reference's mean flux. In a periodic cell the level of temperature is
free, so the mean difference is taken off before temperatures are compared.

`fields` compares one Field with another, `values` numbers already at hand, `checks` need no reference.
"""

from demheat.referee.fields import Error, conductivity_error, flux_error, span, temperature_error
from demheat.referee.one_field import bound_violation, heat_balance
from demheat.referee.values import CurveError, curve_error, dispersion, rms, value_error, variation, vector_error, worst

__all__ = [
    "CurveError",
    "Error",
    "bound_violation",
    "conductivity_error",
    "curve_error",
    "dispersion",
    "flux_error",
    "heat_balance",
    "rms",
    "span",
    "temperature_error",
    "value_error",
    "variation",
    "vector_error",
    "worst",
]
