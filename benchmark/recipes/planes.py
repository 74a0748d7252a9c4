"""Layers, across and along, with surfaces that resist, and of tensors; and patterns of the plane with closed forms."""

import math
from functools import partial

from benchmark.recipes.entries import CUBE, GRADIENT, MATRIX, ROUNDING, WALLS, Entry, fields, number
from demheat.gallery import scaled
from demheat.scene import Box, Cylinder, Layer, Material, Scene
from references import exact
from references.exact.squares import checkerboard, square_rods

# An interface on no face of a usual grid of voxels.
OFF = 0.3137
# Height of boxes of what does not change along z.
FLAT = 0.25
TENSORS = (((2.0, 0.5, 0.0), (0.5, 1.0, 0.0), (0.0, 0.0, 1.0)), ((5.0, -1.0, 0.3), (-1.0, 3.0, 0.0), (0.3, 0.0, 8.0)))
MEANS = "one over the sum of thickness over conductivity, and of what surfaces resist, across; the mean along"
# What is between walls and insulated sides is mirrored by them.
OBNOSOV = {
    "how": "sqrt((1 + 3 s)/(3 + s)), s the contrast",
    "source": "Obnosov, SIAM J. Appl. Math. 59 (1999) 1267",
}
KELLER = {
    "how": "the root of the contrast; walls and insulated sides mirror the box, which is a quarter of a cell",
    "source": "Keller, J. Math. Phys. 5 (1964) 548; Dykhne, Sov. Phys. JETP 32 (1971) 63",
}
CRASTER = {
    "how": (
        "squares a b above d c: k^2 = (abc + abd + acd + bcd)/(a + b + c + d) (a + d)(b + c)/((a + b)(d + c)) along "
        "the rows; here a, b, c, d = 1, 3, 0.2, 5, rows along x, a at the upper left; mirrored as the checkerboard"
    ),
    "source": "Craster and Obnosov, SIAM J. Appl. Math. 61 (2001) 1839; Milton, J. Math. Phys. 42 (2001) 4873",
}
RAYLEIGH = {
    "by": "series",
    "how": "Rayleigh's series in the plane, degrees raised until thirteen digits stand (references/exact/fibres.py)",
    "source": "Rayleigh, Phil. Mag. 34 (1892) 481; Perrins, McKenzie and McPhedran, Proc. R. Soc. A 369 (1979) 207",
}
FIBRES = {
    "fibres-square-f50-s10": ("square", 0.5, 10.0, 0.0),
    "fibres-square-f70-s50": ("square", 0.7, 50.0, 0.0),
    "fibres-square-f30-pore": ("square", 0.3, 0.0, 0.0),
    "fibres-square-f50-s10-r0.5": ("square", 0.5, 10.0, 0.5),
    "fibres-hexagonal-f50-s10": ("hexagonal", 0.5, 10.0, 0.0),
    "fibres-hexagonal-f80-s0.1": ("hexagonal", 0.8, 0.1, 0.0),
}


def entries():
    """Names, and what makes each."""
    yield from _layers()
    yield from _squares()
    for name, given in FIBRES.items():
        yield name, partial(_fibres, name, *given)
    yield "fibre-coated", _coated_fibre


def _layers():
    ten, thousand = scaled(MATRIX, 10.0), scaled(MATRIX, 1000.0)
    three = [Layer(0, 0.11, 0.37, ten), Layer(0, 0.37, 0.52, scaled(MATRIX, 0.2)), Layer(0, 0.83, 0.9, thousand)]
    resisting = [Layer(0, 0.2, 0.4137, ten, resistance=0.3), Layer(0, 0.7, 0.8, ten, resistance=0.05)]
    for name, title, layers, load in (
        ("laminate-across", "half and half, contrast 10, across", [Layer(0, 0.25, 0.75, ten)], {"walls": WALLS}),
        ("laminate-off-grid", "an interface off the grid, contrast 10", [Layer(0, 0.0, OFF, ten)], {"walls": WALLS}),
        ("laminate-along", "contrast 10, along", [Layer(2, 0.0, OFF, ten)], {"walls": WALLS}),
        ("laminate-s1000", "contrast 1000, across", [Layer(0, 0.1, OFF, thousand)], {"gradient": GRADIENT}),
        ("laminate-three", "three layers that touch or not, .2, 10 and 1000", three, {"walls": WALLS}),
        ("laminate-resisting", "layers whose surfaces resist .3 and .05 m2 K/W", resisting, {"walls": WALLS}),
    ):
        scene = Scene(CUBE, MATRIX, layers, **load)
        yield name, partial(_layered, name, title, scene)
    one, two = (Material(each) for each in TENSORS)
    scene = Scene(CUBE, one, [Layer(1, 0.2, 0.7137, two)], gradient=(1.0, 0.5, -0.25))
    yield (
        "laminate-tensors",
        partial(_layered, "laminate-tensors", "two conductivities that differ with direction, load askew", scene),
    )


def _layered(name, title, scene):
    field = exact.solve(scene)
    known = {"by": "closed form", "how": MEANS, "source": "elementary"}
    if scene.anisotropic:
        known["how"] = "gradient along the layers and flux across them are the same in all; along the load -q.g/g.g"
    known["conductivity"] = number(field.conductivity, 0.0, "rounding")
    return Entry(name, "laminates", title, scene, known | {"fields": fields(field, ROUNDING)})


def _squares():
    box = {"size": (1.0, 1.0, FLAT), "matrix": MATRIX, "walls": WALLS}
    for s in (4.0, 10.0, 0.0):
        name, title = f"square-rods-{f's{s:g}' if s else 'pore'}", f"square rods on a quarter of the area, s = {s:g}"
        scene = Scene(**box, inclusions=[_square(0.5, 0.5, s)])
        yield name, partial(_plane, name, title, scene, square_rods(s), OBNOSOV)
    for s in (10.0, 100.0):
        scene, name = Scene(**box, inclusions=[_square(x, x, s) for x in (0.25, 0.75)]), f"checkerboard-s{s:g}"
        yield name, partial(_plane, name, f"checkerboard, contrast {s:g}", scene, checkerboard(s), KELLER)
    a, b, c, d = 1.0, 3.0, 0.2, 5.0
    boards = [_square(0.75, 0.75, b), _square(0.75, 0.25, c), _square(0.25, 0.25, d)]
    scene, name = Scene(**box, inclusions=boards), "checkerboard-four"
    yield name, partial(_plane, name, "checkerboard of four materials", scene, four_squares(a, b, c, d), CRASTER)


def _square(x, y, conductivity):
    return Box((x, y, FLAT / 2), (0.5, 0.5, 1.0), Material(conductivity))


def four_squares(a, b, c, d) -> float:
    """Conductivity along the rows of squares a b above d c repeated (Craster and Obnosov 2001)."""
    triples = a * b * c + a * b * d + a * c * d + b * c * d
    return math.sqrt(triples / (a + b + c + d) * (a + d) * (b + c) / ((a + b) * (d + c)))


def _plane(name, title, scene, value, known):
    known = {"by": "closed form", **known, "conductivity": number(value, 0.0, "rounding")}
    return Entry(name, "patterns of the plane", title, scene, known)


def _fibres(name, kind, fraction, contrast, rho):
    size = (1.0, 1.0 if kind == "square" else math.sqrt(3.0), FLAT)
    centers = [(0.5, size[1] / 2)] if kind == "square" else [(0.25, size[1] / 4), (0.75, 0.75 * size[1])]
    radius = math.sqrt(fraction * size[0] * size[1] / (len(centers) * math.pi))
    material = scaled(MATRIX, contrast)
    shapes = [Cylinder((*c, FLAT / 2), radius, (0, 0, 1), material, resistance=rho * radius) for c in centers]
    scene = Scene(size, MATRIX, shapes, gradient=GRADIENT)
    field = exact.solve(scene)
    known = RAYLEIGH | {"conductivity": number(field.conductivity, 10.0 ** -field.stats["digits"], "estimate")}
    known["fields"] = fields(field, 10.0 ** -field.stats["field_digits"])
    surface = f", surface R k_m/a = {rho:g}" if rho else ""
    title = f"{kind} array of fibres, across, f = {fraction:g}, s = {contrast:g}{surface}"
    return Entry(name, "fibres", title, scene, known)


def _coated_fibre(core=20.0, shell=2.0, share=0.4, radius=0.4):
    b = (core - shell) / (core + shell)
    outer = shell * (1 + b * share) / (1 - b * share)
    middle = (0.47, 0.55, FLAT / 2)
    shapes = [
        Cylinder(middle, radius, (0, 0, 1), Material(shell)),
        Cylinder(middle, radius * math.sqrt(share), (0, 0, 1), Material(core)),
    ]
    scene = Scene((1.0, 1.0, FLAT), Material(outer), shapes, walls=WALLS)
    how = (
        "neutral inclusion: matrix k1 (1 + b f)/(1 - b f), b = (k2 - k1)/(k2 + k1), of core k2, shell k1 and the "
        "core's share f. The conductivity is the matrix's"
    )
    source = "Hashin and Rosen, J. Appl. Mech. 31 (1964) 223"
    known = {"by": "closed form", "how": how, "source": source, "conductivity": number(outer, 0.0, "rounding")}
    title = f"coated fibre that its matrix does not notice, core {core:g}, shell {shell:g}"
    return Entry("fibre-coated", "fibres", title, scene, known)
