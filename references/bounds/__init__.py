"""Bounds and estimates of the conductivity of isotropic composites, as plain functions; `estimate` takes a scene.

Two-phase functions take (k_matrix, k_inclusion, fraction), fraction that of the inclusions; all arguments broadcast, in
any unit of conductivity.
"""

from typing import TYPE_CHECKING

from demheat.method import Errors, Method
from demheat.runtime.lazy import lazy_names
from references.bounds.formulas import (
    agari_uno,
    bruggeman,
    bruggeman_differential,
    hashin_shtrikman,
    lewis_nielsen,
    maxwell,
    rayleigh,
    reuss,
    third_order,
    torquato,
    voigt,
    zeta2_hard_spheres,
)

if TYPE_CHECKING:
    from references.bounds.scenes import estimate

__all__ = [
    "agari_uno",
    "bruggeman",
    "bruggeman_differential",
    "estimate",
    "hashin_shtrikman",
    "lewis_nielsen",
    "maxwell",
    "rayleigh",
    "reuss",
    "third_order",
    "torquato",
    "voigt",
    "zeta2_hard_spheres",
]

FORMULA = {
    "role": "beside",
    "call": "estimate",
    "exceptions": {"field": "a formula knows the conductivity alone"},
    "refuses": {
        "layers": "formulas are of spheres",
        "nested": "conductivities",
        "unlike": "conductivities",
        "cut": "a wall",
    },
}
# Errors at 15 % of spheres; at half of the volume all are tens of per cent off but Rayleigh's, of cubic arrays.
METHODS = (
    Method(name="maxwell", title="Maxwell", **FORMULA, errors=Errors(6.6e-4), look=("grey", "", "-.")),
    Method(name="rayleigh", title="Rayleigh", knobs={"formula": "rayleigh"}, **FORMULA, errors=Errors(6.1e-6)),
    Method(name="bruggeman", title="Bruggeman", knobs={"formula": "bruggeman"}, **FORMULA, errors=Errors(8.3e-2)),
    Method(
        name="bruggeman-differential",
        title="Bruggeman, differential",
        knobs={"formula": "bruggeman_differential"},
        **FORMULA,
        errors=Errors(3.6e-2),
    ),
)

# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, {"references.bounds.scenes": ("estimate",)})
