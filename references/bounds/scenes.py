"""The conductivity of a scene by one of the formulas of isotropic dispersions."""

from __future__ import annotations

from demheat.scene import Scene, Sphere
from references.bounds.formulas import bruggeman, bruggeman_differential, maxwell, rayleigh
from references.exact.solver import fractions

FORMULAS = {
    "maxwell": maxwell,
    "rayleigh": rayleigh,
    "bruggeman": bruggeman,
    "bruggeman_differential": bruggeman_differential,
}


def estimate(scene: Scene, *, formula: str = "maxwell") -> float:
    """Effective conductivity of a scene by one of the formulas of isotropic dispersions.

    Parameters
    ----------
    scene : Scene
        Spheres of one material, which no wall cuts.
    formula : {"maxwell", "rayleigh", "bruggeman", "bruggeman_differential"}

    Returns
    -------
    float, W/(m K)

    Raises
    ------
    ValueError
        If there is no such formula.
    NotImplementedError
        For other shapes, unlike spheres, and spheres that a wall cuts.
    """
    if formula not in FORMULAS:
        raise ValueError(f"formula = {formula!r}: must be one of {', '.join(FORMULAS)}")
    scene.require("formulas are of spheres in a matrix", shapes=(Sphere,))
    found = {inclusion.material.conductivity for inclusion in scene.inclusions}
    if len(found) > 1:
        raise NotImplementedError(f"bounds: spheres of {len(found)} conductivities; formulas are of two phases")
    k1 = scene.matrix.conductivity
    return float(FORMULAS[formula](k1, *(found or {k1}), fractions(scene)[1:].sum()))
