"""Certain bounds: how narrow the bracket of two admissible solutions is, what it costs, and whether it ever fails.

A temperature that fits the load bounds the conductivity from above (Dirichlet), a balanced flux from below (Thomson);
`references.bracket` works both out on one mesh whose curved interfaces are pushed to the safe side. `drawn`: forty
scenes with an exact conductivity, drawn by seed, none of them used for anything else: cubic arrays, spheres between
walls, coated spheres, laminates, random spheres of several sizes and materials. `refined`: the sphere in a cube on
finer and finer meshes. `voxels`: the same sphere on voxels that know nothing of it but how much is in them.
`judged`: 40 spheres at contrast 150 between walls as each method answers by default, beside the bracket.
"""

from demheat.runtime.lazy import lazy_names
from studies.brackets.scenes import DRAWN, KINDS
from studies.harness import methods
from studies.harness.pick import pick
from studies.harness.tolerance import Tolerance

__getattr__, __dir__ = lazy_names(
    __name__, {"studies.brackets.tables": ("table",), "studies.brackets.figure": ("plot",)}
)

EACH = 8  # drawn scenes of a kind
# Edges of the finest of elements beside the box, by scene.
REFINED = {"sphere": (6, 8, 12, 16, 32)}
VOXELS = (8, 16, 32, 64, 128)  # along the cube's edge
JUDGED = ("dem", "fft", "fem")
MODULES = {"bracket": "references.bracket", "bracket-voxels": "references.bracket.voxels"}
# Of the sphere's narrowest bracket, %, with so many edges of elements beside the box and more.
NARROW = {32: 0.004, 12: 0.1}
TIMEOUT = 3600.0
# What is left of a balance is rounding of sums: seen are 1e-5 of it on another processor of the same name.
TOLERANCES = {"unbalanced": Tolerance(1e-4, 1e-12)}


def _cases():
    for seed in range(EACH):
        for kind in KINDS:
            yield {"part": "drawn", "scene": kind, "seed": seed, "parts": DRAWN, "method": "bracket"}
    for scene, sizes in REFINED.items():
        for parts in sizes:
            yield {"part": "refined", "scene": scene, "parts": parts, "method": "bracket"}
    for voxels in VOXELS:
        yield {"part": "voxels", "scene": "sphere", "voxels": voxels, "method": "bracket-voxels"}
    yield {"part": "judged", "scene": "40 spheres", "parts": 40, "method": "bracket"}
    for name in JUDGED:
        yield methods.case(name, part="judged", scene="40 spheres")


CASES = list(_cases())


def QUICK(case):
    """One scene of each kind; the sphere on its coarsest meshes and grids."""
    if case["part"] == "drawn":
        return case["seed"] < 1
    if case["part"] == "voxels":
        return case["voxels"] <= 16
    return case["scene"] == "sphere" and case["parts"] <= 12


def VALUES(case):
    """What is judged, and drawn scenes but for the first of each kind, whose costs stand for all."""
    return case["part"] == "judged" or (case["part"] == "drawn" and case["seed"] > 0)


def run(part, scene, parts=None, seed=None, name=None, *, method, **knobs):
    """Bound the conductivity of a scene, or answer by a method."""
    from studies.brackets import rows

    if part == "voxels":
        return rows.on_voxels(scene, **knobs)
    if name is not None:
        return rows.answered(scene, method=method, **knobs)
    return rows.bounded(scene, seed, parts)


def warm_up(part, scene, parts=None, seed=None, name=None, *, method, **knobs):
    """Load what meshes and solves; compile what a method needs."""
    from studies.brackets import rows

    if part == "voxels":
        rows.on_voxels(scene, voxels=4)
    elif name is None:
        rows.bounded("sphere", None, 3)
    else:
        methods.warm_up(method, **knobs)


def claims(df):
    """The bracket holds, closes in, and is narrow.

    Before there was one 1 % was asked for of drawn scenes and of 40 spheres, .1 % of the sphere;
    when the widths were known limits were brought to two or three times these.
    """
    drawn = pick(df, part="drawn")
    if len(drawn):
        yield f"Exact values outside of their brackets, of {len(drawn)} scenes", _outside(drawn), 0
        yield "Median width of the drawn scenes' brackets, %", drawn["width_percent"].median(), 0.25
    yield from _refined(pick(df, part="refined"))
    yield from _on_voxels(pick(df, part="voxels"))
    judged = pick(df, part="judged", method="bracket")
    if len(judged):
        yield "40 spheres, contrast 150: width, %", judged["width_percent"].iloc[0], 0.3


def _outside(rows):
    """How many exact values are not known to lie in their brackets; None without rows."""
    return int((~rows["inside"].eq(True)).sum()) if len(rows) else None


def _refined(sphere):
    """Widths; faster than second order."""
    from studies.brackets.means import narrowest, order_of_width

    limit = next((width for parts, width in NARROW.items() if (sphere["parts"] >= parts).any()), 0.1)
    yield "Sphere, contrast 10: narrowest bracket, %", narrowest(sphere), limit
    yield "Sphere, contrast 10: order of the width in the edge of elements", order_of_width(sphere), ">= 2"
    yield "Refined scenes: exact values outside of their brackets", _outside(sphere), 0


def _on_voxels(rows):
    """First order, for what a surface cuts goes as the edge of voxels; few of them are not regular."""
    from studies.brackets.means import order_of_width

    yield "Sphere on voxels: order of the width in their edge", order_of_width(rows), ">= 0.8"
    yield "Sphere on voxels: exact values outside of their brackets", _outside(rows), 0


def words(df):
    """How many brackets hold, how wide they are, what narrow ones cost, and where methods' answers lie."""
    from studies.brackets.means import beside, narrow

    drawn, held = pick(df, part="drawn"), pick(df, part="judged", method="bracket").iloc[0]
    others = pick(df, part="judged")
    parts = [narrow(pick(df, part="refined", scene=scene), scene) for scene in REFINED]
    return (
        f"of {len(drawn)} drawn scenes with an exact conductivity {len(drawn) - _outside(drawn)} hold it, with a "
        f"median width of {drawn['width_percent'].median():.2g} %; narrower ones cost more: {', '.join(parts)}; "
        f"40 spheres at contrast 150 between walls to {held['width_percent']:.2g} %, beside "
        f"which stand the answers of {', '.join(beside(others[others['method'] != 'bracket'], held))}"
    )
