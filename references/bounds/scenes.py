"""The conductivity of a scene by one of the formulas of isotropic dispersions."""

from demheat.scene import Scene, Sphere, check_scene
from demheat.scene.inputs import chosen
from demheat.scene.volumes import fractions
from references.bounds.formulas import bruggeman, bruggeman_differential, maxwell, rayleigh

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

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import bounds
    >>> print(f"{bounds.estimate(gallery.sphere_in_cube(5.0)):.3f}")  # exactly 42.640
    42.630
    """
    chosen("formula", formula, FORMULAS)
    check_scene(scene)
    scene.require("formulas are of spheres in a matrix", shapes=(Sphere,))
    found = {inclusion.material.conductivity for inclusion in scene.inclusions}
    if len(found) > 1:
        raise NotImplementedError(f"bounds: spheres of {len(found)} conductivities; formulas are of two phases")
    k1 = scene.matrix.conductivity
    return float(FORMULAS[formula](k1, *(found or {k1}), fractions(scene)[1:].sum()))
