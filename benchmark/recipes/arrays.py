"""Cubic arrays of spheres by Rayleigh's series, and coated spheres that their matrix does not notice."""

import math
from functools import partial

from benchmark.recipes.entries import CUBE, GRADIENT, MATRIX, ROUNDING, WALLS, Entry, fields, number
from demheat.gallery import coated_sphere, scaled
from demheat.scene import Scene, Sphere
from references import exact

THIRD, HALF, TENTH = 1 / 3, (3 / (8 * math.pi)) ** (1 / 3), (3 / (40 * math.pi)) ** (1 / 3)
SITES = {
    "bcc": [(0.25, 0.25, 0.25), (0.75, 0.75, 0.75)],
    "fcc": [(0.25, 0.25, 0.25), (0.25, 0.75, 0.75), (0.75, 0.25, 0.75), (0.75, 0.75, 0.25)],
}
# Name: radius, contrast, resistance of the surface times the matrix's conductivity over the radius.
SIMPLE = {
    "sc-f10-s10": (TENTH, 10.0, 0.0),
    "sc-third-s2": (THIRD, 2.0, 0.0),
    "sc-third-s10": (THIRD, 10.0, 0.0),
    "sc-third-s100": (THIRD, 100.0, 0.0),
    "sc-third-s0.01": (THIRD, 0.01, 0.0),
    "sc-third-pore": (THIRD, 0.0, 0.0),
    "sc-f50-s0.1": (HALF, 0.1, 0.0),
    "sc-f50-s10": (HALF, 10.0, 0.0),
    "sc-f50-s1000": (HALF, 1000.0, 0.0),
    "sc-third-s10-r0.1": (THIRD, 10.0, 0.1),
    "sc-third-s10-r0.9": (THIRD, 10.0, 0.9),
    "sc-third-s10-r5": (THIRD, 10.0, 5.0),
    "sc-f50-s100-r0.2": (HALF, 100.0, 0.2),
}
# Name: kind, fraction, contrast, resistance.
CENTRED = {
    "bcc-f30-s10": ("bcc", 0.3, 10.0, 0.0),
    "bcc-f60-s50": ("bcc", 0.6, 50.0, 0.0),
    "bcc-f30-s10-r1": ("bcc", 0.3, 10.0, 1.0),
    "fcc-f30-s0.1": ("fcc", 0.3, 0.1, 0.0),
    "fcc-f65-s10": ("fcc", 0.65, 10.0, 0.0),
}
# Core, shell, outer radius, the core's share of the coated sphere, centre.
COATED = {
    "coated-s10": (10.0, 1.0, 0.4, 0.4, (0.5, 0.5, 0.5)),
    "coated-off-centre": (100.0, 0.5, 0.35, 0.3, (0.43, 0.52, 0.58)),
    "coated-hollow": (0.0, 5.0, 0.4, 0.5, (0.5, 0.5, 0.5)),
}
RAYLEIGH = (
    "Rayleigh's series for the array, degrees raised until twelve digits stand (references/exact/lattice.py); the "
    "error is the change from three quarters of the degree to all of it, thrice"
)
SOURCE = (
    "Rayleigh, Phil. Mag. 34 (1892) 481; McPhedran and McKenzie, Proc. R. Soc. A 359 (1978) 45; Sangani and Acrivos, "
    "Proc. R. Soc. A 386 (1983) 263"
)
HASHIN = (
    "neutral inclusion: matrix k1 (1 + 2 b f)/(1 - b f), b = (k2 - k1)/(k2 + 2 k1), of core k2, shell k1 and the "
    "core's share f; outside the temperature is linear. The conductivity is the matrix's"
)


def entries():
    """Names, and what makes each."""
    for name, (radius, contrast, rho) in SIMPLE.items():
        material = scaled(MATRIX, contrast)
        sphere = Sphere((0.5, 0.5, 0.5), radius, material, resistance=rho * radius)
        told = f"simple cubic array, f = {4 / 3 * math.pi * radius**3:.4g}, {_said(contrast, rho)}, as a box"
        yield name, partial(_array, name, told, Scene(CUBE, MATRIX, [sphere], walls=WALLS))
    for name, (kind, fraction, contrast, rho) in CENTRED.items():
        radius = (3 * fraction / (4 * math.pi * len(SITES[kind]))) ** (1 / 3)
        material = scaled(MATRIX, contrast)
        spheres = [Sphere(site, radius, material, resistance=rho * radius) for site in SITES[kind]]
        full = {"bcc": "body-centred", "fcc": "face-centred"}[kind]
        told = f"{full} cubic array, f = {fraction:g}, {_said(contrast, rho)}"
        yield name, partial(_array, name, told, Scene(CUBE, MATRIX, spheres, gradient=GRADIENT))
    for name, given in COATED.items():
        yield name, partial(_coated, name, *given)


def _coated(name, core, shell, radius, share, center):
    drawn = coated_sphere(core, shell, radius=radius, core_fraction=share, center=center, edge=1.0)
    scene = Scene(CUBE, drawn.matrix, drawn.inclusions, walls=WALLS)
    field = exact.solve(scene)
    known = {"by": "closed form", "how": HASHIN, "source": "Hashin, J. Appl. Mech. 29 (1962) 143"}
    known |= {"conductivity": number(field.conductivity, 0.0, "rounding"), "fields": fields(field, ROUNDING)}
    title = f"coated sphere in the matrix that does not notice it, core {core:g}, shell {shell:g}"
    return Entry(name, "coated spheres", title, scene, known)


def _said(contrast, rho):
    surface = f", surface R k_m/a = {rho:g}" if rho else ""
    return ("pores" if contrast == 0 else f"contrast {contrast:g}") + surface


def _array(name, title, scene):
    field = exact.solve(scene)
    known = {"by": "series", "how": RAYLEIGH, "source": SOURCE}
    known["conductivity"] = number(field.conductivity, 10.0 ** -field.stats["digits"], "estimate")
    known["fields"] = fields(field, 10.0 ** -field.stats["field_digits"])
    return Entry(name, "cubic arrays", title, scene, known)
