"""The scenes of `benchmark/`: every method's error against its cost, and that of a method of your own.

Bodies whose conductivity, or temperatures, are known by closed forms, series, multipoles or certain bounds
(`benchmark/README.md`). Errors are of the conductivity in per cent of what is known, and where temperatures are asked
for the worst of them in per cent of their span. Relations need no known value: a uniform body, conductivities seven
times as large, walls exchanged, axes turned, all lengths tenfold. `python -m studies run sphere_benchmark --method
my_package.my_module`, or `./my_program`, adds rows of a method that nobody here has heard of (`docs/benchmark.md`).
"""

import re
import tempfile
from contextlib import nullcontext

import benchmark
from studies.harness import methods
from studies.sphere_benchmark.cases import GUEST, LADDERS, MOST, POROUS, RELATIONS

TIMEOUT = 900.0
# Limits that are far from the values, and why they are no nearer.
REASONS = {f"relation {name}": "rounding, which differs by processor" for name in ("uniform", "scaled", "reversed")}
REASONS["fem, finest, but for patterns of squares: worst"] = (
    "of scenes with the most spheres, too, which have no rows now"
)
# Why claims on the stored rows fail.
FAILS = {
    "fft, finest, but for patterns": (
        "the study asks for laminate voxels, which the solver by itself leaves for links at high contrast: with these "
        "the worst scene, sc-f50-s1000, is 0.023 % off on the same 64^3 voxels"
    ),
    "multipole, finest, but for patterns": (
        "one limit was set for all scenes; where spheres nearly touch degree 7 is too low: of 15 it errs by a twentieth"
    ),
}
MODULES = {GUEST: "studies.sphere_benchmark.ways"}
KEY = re.compile(rf"name=(.+),scene=([\w. -]+),step=(\d+),method={GUEST}")
IN_TIME = ("dem", "fem")
ROUND = ("cubic arrays", "coated spheres", "dispersions")
QUICK_SCENES = ("sc-third-s10", "laminate-off-grid", "slab-step")
# What lies between others, and laminates in which all are exact: a method of somebody else is asked for these, too.
BETWEEN = (
    *("bcc-f30-s10-r1", "sc-f10-s10", "sc-third-s10-r0.1", "sc-third-s10-r5", "sc-third-s2", "dispersion-20-s0.1"),
    *("dispersion-20-s100", "dispersion-unlike", "fibres-square-f50-s10", "fibres-square-f50-s10-r0.5"),
    *("square-rods-s4", "laminate-across", "laminate-along", "laminate-three", "slab-flux", "ball-step"),
)
# Scenes at every resolution, and with costs.
TIMED = (*QUICK_SCENES, "sc-third-s0.01", "sc-third-s100", "bcc-f60-s50", "fcc-f30-s0.1")
QUICK_RELATIONS = (("relation scaled", "fft"), ("relation scaled", "maxwell"))


def _cases():
    groups = {name: benchmark.read(name)["group"] for name in benchmark.names()}
    for scene, group in groups.items():
        timed = group in ("transients", "NAFEMS")
        for name, (column, values) in LADDERS.items():
            if group == "published images" or (name in ("multipole", "maxwell") and group not in ROUND):
                continue
            # Multipoles and the formula cost next to nothing.
            if scene in BETWEEN and name not in ("multipole", "maxwell"):
                continue
            if not timed or name in IN_TIME:
                if name == "fft" and scene in POROUS:
                    values = values[:1]
                elif scene not in TIMED:
                    values = values[-1:]
                if (name == "fem" and scene in MOST) or (name, scene) == ("fft", POROUS[-1]):
                    values = ()
                for value in values:
                    yield methods.case(name, scene=scene, **({column: value} if column else {}))
    for relation in RELATIONS:
        for name, (column, values) in LADDERS.items():
            yield methods.case(name, scene=f"relation {relation}", **({column: values[0]} if column else {}))


CASES = list(_cases())

# Layers, of which all is exact, tell nothing of spheres: one of them had borne out thirty rows that had moved.
BY_ITSELF = ("scene",)


def QUICK(case):
    """Coarse rows of an array, a laminate and a slab in time, and one relation."""
    finer = case.get("particles", 0) > 2_000 or case.get("voxels", 0) > 32 or case.get("size", 1.0) < 0.2
    return not finer and (case["scene"] in QUICK_SCENES or (case["scene"], case["name"]) in QUICK_RELATIONS)


def VALUES(case):
    """Relations, and scenes at one resolution; costs are of those that have several."""
    return case["method"] != GUEST and case["scene"] not in TIMED


def guests(method, *, quick=False):
    """Cases of a method that is not ours: all scenes and relations, at each of its knobs."""
    from studies.sphere_benchmark import ways

    there = [case["scene"] for case in CASES if not quick or QUICK(case)]
    scenes = list(dict.fromkeys([*there, *(() if quick else BETWEEN)]))
    steps = range(len(ways.knobs_of(method)))
    return [{"name": method, "scene": scene, "step": step, "method": GUEST} for scene in scenes for step in steps]


def guest_case(key):
    """The case of a method that is not ours, by its key; None if it is no such key. The method need not be there."""
    found = KEY.fullmatch(key)
    return found and {"name": found[1], "scene": found[2], "step": int(found[3]), "method": GUEST}


def run(name, scene, method, **knobs):
    """Solve a scene, or the two of a relation, by one method."""
    from studies.sphere_benchmark import rows, ways

    way = ways.guest(name, knobs["step"]) if method == GUEST else ways.ours(method, knobs)
    # The DEM makes its packing on the spot.
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder) if method == "dem" else nullcontext():
        if scene.startswith("relation "):
            return rows.related(scene.removeprefix("relation "), way)
        return rows.solved(scene, way)


def warm_up(name, scene, method, **knobs):
    """Load our solvers; a guest is asked once for a scene that is cheap, unless it is a program."""
    from studies.sphere_benchmark import ways

    if method == GUEST:
        ways.warm_up(name, knobs["step"])
    else:
        fixed = {key: value for key, value in knobs.items() if key not in ("particles", "size", "voxels", "degree")}
        methods.warm_up(method, **fixed)


def claims(df):
    """What is known is what the files say; the limits of errors were set before the rows were seen."""
    from studies.sphere_benchmark.means import all_claims, whole

    return all_claims(whole(df))


def table(df):
    """|error| in % by scene, each method at its finest; "-" refused or not asked, "!" failed.

    `known` is the value of the file, W/(m K), empty where temperatures are asked for. Last come relations.
    """
    from studies.sphere_benchmark import means, tables

    return tables.by_scene(means.whole(df))


def notes(df):
    """Over all scenes: how many each method answers, its median and worst error, what it costs."""
    from studies.harness.table import markdown
    from studies.sphere_benchmark import means, tables

    return [
        "Over the scenes that each has, at each resolution; coarse ones are of fewer scenes:",
        markdown(tables.by_method(means.whole(df))),
    ]


def plot(df):
    """Every method's errors against its costs, and how many scenes it answers to a given error."""
    from studies.sphere_benchmark.figure import draw
    from studies.sphere_benchmark.means import whole

    return draw(whole(df))
