"""Surfaces without formulas: gyroid, primitive, diamond, random fields, overlapping spheres, a checkerboard, a knot.

The labyrinths of three minimal surfaces, by their nodes, at fractions from .1 to .9; a level cut of twelve random
waves, much like a Gaussian field; spheres at random places that overlap, below and above the fraction .29 at which they
join through; checkerboards in three dimensions as images, in order and at random; a trefoil of triangles. What does not
reach through the cell conducts without bound, too. No exact value is known of any: the DEM, the FFT and finite
elements, are held against each other and against bounds of the fractions that they have (Hashin and Shtrikman's of the
labyrinths, which are cubic, else those of layers; of checkerboards those of two admissible fields,
`references.bracket.voxels`). Where walkers, who have no grid (`references.walkers`), reach an interval of a per cent or
two in two minutes they are the referee: right is what lies in it, or within 2 %. Both labyrinths of each surface are
alike, so a contrast of .01 at a fraction is 100 at the rest, a hundredth of it. Of half a labyrinth that does not
conduct a third is left, as was found of P and D (Torquato, Hyun and Donev 2002).
"""

import math

from demheat.runtime.lazy import lazy_names
from studies.formless.parts import BAD, BOARDS, BRICKS, CHECKERED, FRACTIONS, GOOD, HALF, LABYRINTHS
from studies.harness import methods
from studies.harness.tolerance import Tolerance

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "studies.formless.walked": ("words",),
        "studies.formless.tables": ("table",),
        "studies.formless.figure": ("plot",),
    },
)

# What the DEM and the FFT are asked of these, who pay for each point of a surface.
OF_ALL = (0.1, 0.5, 0.9)
# Particles, voxels along an edge, size of elements in edges; elements once more, finer.
SPENT, FINE, FINER = {"dem": 8_000, "fft": 32, "fem": 1 / 12}, 1 / 18, 1 / 24
# Necks of these are thin: of labyrinths of little and of what is left of them, and of spheres that overlap.
THIN = {"diamond": 1 / 32, "gyroid": FINER}
NARROW, NECKED, MANY = (0.1, 0.9), (1 / 40, 1 / 48), 27_000
THINNER = 1 / 40
# What stands apart from its images.
ALONE = (("primitive", 0.1), ("knot", None))
# The knot's tube is a tenth of an edge thick.
ON_KNOT = (1 / 24, 1 / 32)
# Beside pores laminates of voxels do not converge: plain ones, more of them. Beside perfect conductors they do not, or
# are a tenth off: links, which the method takes there by itself.
PLAIN = 64
# Part, contrast and fraction of what all three take.
OTHERS = (
    ("random field", GOOD, 0.3),
    ("overlapping spheres", GOOD, 0.24),
    ("overlapping spheres", GOOD, 0.34),
    ("random field", BAD, 0.3),
    ("overlapping spheres", BAD, 0.24),
    ("knot", GOOD, None),
    ("knot", BAD, None),
)
# Walks of walkers by part, contrasts and fraction, and radius of balls on surfaces in edges.
RADIUS, FINE_RADIUS = 0.03, 0.01
WALKS = (
    *((part, (0.0, BAD), HALF, 2000) for part in LABYRINTHS),
    *((part, (0.0, BAD), 0.1, 600) for part in LABYRINTHS),
    ("random field", (BAD,), 0.3, 1200),
    ("overlapping spheres", (BAD,), 0.24, 1000),
    ("knot", (BAD,), None, 300),
)
# Voxels of certain bounds of checkerboards.
CERTAIN = 128
# Limits from elsewhere: twice a witness's own interval.
ELSEWHERE = ("halves of their intervals",)
MODULES = {"walkers": "references.walkers", "bracket-voxels": "references.bracket.voxels"}
# On another processor they go other ways: two means are 1.4 of half an interval of 2 % apart, twice in a hundred times
# as much again, and their lag may be the next.
TOLERANCES = {"walked_ratio": Tolerance(0.06, 0.0), "walked_half_percent": Tolerance(0.8, 0.0)}
# Largest distance from elements, %, over the rows of a part. They were set before rows were seen; known were of the
# gyroid at a half and contrast 10 .03 and .15 %, and at 100 that links of 32 voxels are 5 % below. Links
# beside perfect conductors were added later, with the limits of the FFT, when their first values were known.
APART = {
    "labyrinths": {"dem": 2.0, "fft": 6.0, "fft-links": 6.0, "fft-plain": 4.0},
    "random field": {"dem": 3.0, "fft": 8.0},
    "overlapping spheres": {"dem": 4.0, "fft": 10.0},
    "knot": {"dem": 2.0, "fft": 4.0, "fft-links": 4.0},
}
REASONS = {
    "largest distance from elements": "set before the rows were seen; those of links are the limits of the FFT",
    "largest distance from walkers": "set when primitive ones were known, a fifth of one",
    "outside of walkers' intervals": "of twenty right values more than three are outside twice in a hundred times",
    "contrast .01 beside 100": "set before it was seen that the meshes of both share the symmetry",
}
FAILS = {
    "overlapping spheres, DEM": "particles are wider than the necks by which spheres join; elements and voxels agree",
    "largest change to coarser ones": "of overlapping spheres, whose necks and gaps are of any width",
    "outside of certain bounds": "bricks bound from above, and slowly where four cells meet; bounds have finer ones",
    "bricks of half the size": "fluxes are without bound at edges where four cells meet, the more the contrast",
}
TIMEOUT = 3600.0


def _case(name, part, contrast, fraction, value=None):
    value = (SPENT | {"fft-plain": PLAIN, "fft-links": SPENT["fft"]})[name] if value is None else value
    where = {"part": part, "contrast": contrast} | ({} if fraction is None else {"fraction": fraction})
    return methods.case(name, **where, **methods.at(methods.all_methods()[name], value))


def _finest(name, part, fraction):
    """What is spent on a scene where it is not the usual."""
    narrow = part in THIN and fraction in NARROW
    if name == "fem":
        return THIN[part] if narrow else None
    return MANY if name == "dem" and (narrow or part == "overlapping spheres") else None


def _cases():
    for part in LABYRINTHS:
        for fraction in FRACTIONS:
            for contrast in (0.0, BAD, GOOD):
                yield _case("fem", part, contrast, fraction, _finest("fem", part, fraction))
            for name in ("dem", "fft") if fraction in OF_ALL else ():
                yield _case(name, part, GOOD, fraction, _finest(name, part, fraction))
        for name in ("dem", "fft-plain"):
            yield _case(name, part, 0.0, HALF)
        yield _case("fem", part, GOOD, HALF, FINE)
    yield _case("fem", "diamond", GOOD, NARROW[0], THINNER)
    for other in OTHERS:
        for name in ("dem", "fft"):
            yield _case(name, *other, _finest(name, other[0], None))
        sizes = {"knot": ON_KNOT, "overlapping spheres": NECKED, "random field": (FINE, FINER)}
        for size in sizes[other[0]]:
            yield _case("fem", *other, size)
    for part, fraction in ALONE:
        for name in ("dem", "fft-links"):
            yield _case(name, part, math.inf, fraction)
        yield _case("fem", part, math.inf, fraction, ON_KNOT[-1])
    for part in BOARDS:
        for contrast in CHECKERED:
            for size in BRICKS:
                yield _case("fem-p1", part, contrast, None, size)
        for contrast in CHECKERED:
            where = {"part": part, "contrast": contrast}
            yield {"name": "bracket", **where, "method": "bracket-voxels", "voxels": CERTAIN}
    for part, contrasts, fraction, walks in WALKS:
        for contrast in contrasts:
            yield _walks(part, contrast, fraction, walks)


def _walks(part, contrast, fraction, walks):
    where = {"part": part, "contrast": contrast} | ({} if fraction is None else {"fraction": fraction})
    # Its tube is a twentieth of an edge in radius.
    radius = FINE_RADIUS if part == "knot" else RADIUS
    return {"name": "walkers", **where, "method": "walkers", "walks": walks, "radius": radius}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """Half labyrinths of the primitive surface, and the knot by elements."""
    return (
        case["part"] == "primitive" and case.get("fraction") == HALF and case["name"] not in ("dem", "walkers")
    ) or (case["part"] == "knot" and case["name"] == "fem")


def run(name, part, contrast, method, fraction=None, **knobs):
    """Solve one scene, or bound or walk it; all over the matrix's conductivity."""
    from studies.formless import rows

    if name == "walkers":
        return rows.walked(part, contrast, fraction, **knobs)
    if name == "bracket":
        return rows.bracketed(part, contrast, **knobs)
    return rows.solved(part, contrast, fraction, method, **knobs)


def claims(df):
    """Distances between methods, from walkers and bounds, fractions, and what symmetry says."""
    from studies.formless import verdicts

    yield from verdicts.claims(df, APART)
