"""Programs that others wrote, beside ours: the same bodies, the same images and meshes, one referee.

Each program runs as its users run it, in a process of its own; one that is not installed has rows that say so. Ours get
what the others get: on an image the image, else the body.
"""

import math
from importlib import import_module
from pathlib import Path

from demheat.referee import value_error
from demheat.runtime.lazy import lazy_names
from studies.harness import methods
from studies.harness.table import markdown
from studies.peers import tables
from studies.peers.cases import EVERY, QUICK_SCENES, our_beds, ours, thinned
from studies.peers.means import AIM, COSTED, ahead, same_mesh

__getattr__, __dir__ = lazy_names(__name__, {"studies.peers.figure": ("plot",)})

HOME = Path(__file__).parent / "programs"
PROGRAMS = tuple(sorted(path.stem for path in HOME.glob("*.py") if path.stem != "__init__"))
# Limits from elsewhere: as dear as ours.
ELSEWHERE = ("other program over ours",)
# Beds of grains are solved by no method, but by `demheat.grains`.
MODULES = {name: f"studies.peers.programs.{name}" for name in PROGRAMS} | {"grains": "studies.peers.beds"}
# What was asked for before any row was made: so many bodies of each program.
FEWEST = 4
# Ours: layers are exact but for the equations' tolerance; a sphere to what linear elements of a 25th of its edge give.
WELL_KNOWN = {"layers off the grid": 1e-7, "sphere 10": 1.0}
# Linear elements on one mesh have one answer; what is left is what their solvers leave.
SAME_MESH, PRINTS_SEVEN_DIGITS = 1e-9, {"calculix": 1e-6}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "sphere 10: the worst of our methods": "of quick rows, too, which have elements of a twelfth of the edge",
    "layers off the grid": "equations are iterated to 1e-8 and 1e-10 of the heat",
    "on the same mesh": "solvers' tolerances, or digits that a program prints",
    "least CPU time": "who is cheaper is what is asked",
}


def program(name):
    """Module of a program by its name."""
    return import_module(MODULES[name])


def _cases():
    for name in PROGRAMS:
        for case in program(name).CASES:
            yield {"name": name, "given": program(name).KIND, **case, "method": name}
    for name, kind, scene, knobs in ours():
        yield methods.case(name, given=kind, scene=scene, **knobs)
    for case in our_beds():
        yield {"name": "grains", "given": "packing", **case, "method": "grains"}


CASES = thinned(list(_cases()))


def QUICK(case):
    """Ours on two bodies, coarsely: what needs no other program."""
    coarse = case.get("n", 0) <= 16 and case.get("voxels", 0) <= 32 and case.get("particles", 0) <= 2000
    return case["name"] not in PROGRAMS and case["scene"] in QUICK_SCENES and coarse and case.get("size", 1.0) > 0.05


def VALUES(case):
    """Bodies on which nobody is compared by costs; an image costs what its voxels do, whatever is in it."""
    return case["scene"] not in COSTED or (case["given"] == "image" and case["scene"] not in EVERY)


def run(name, given, scene, method, **knobs):
    """Solve a body, or its image, by one program."""
    from studies.peers import beds
    from studies.peers.given import known

    if name == "grains":
        found = beds.solved(beds.BEDS[scene], **knobs)
    else:
        found = _ours(given, scene, method, knobs) if method not in MODULES else _theirs(name, scene, knobs)
    return found | {"known": known(scene), "error_percent": 100 * value_error(found["conductivity"], known(scene))}


def _theirs(name, scene, knobs):
    from studies.peers import given

    reason = program(name).missing()
    if reason:
        raise NotImplementedError(reason)
    found = program(name).solve(given.scene(scene), **knobs)
    shown = {"conductivity": found.conductivity, "unknowns": found.unknowns, "iterations": found.iterations}
    return shown | {"version": program(name).version(), "remark": found.note, **found.cost}


def _ours(kind, scene, method, knobs):
    from demheat import Scene
    from studies.harness.cost import measured
    from studies.peers import given

    body = given.scene(scene)
    if kind == "image":
        body = Scene.of_image(given.image(body, knobs.pop("n")), walls=given.WALLS)
    field, cost = measured(methods.load(method).solve, body, **knobs)
    shown = {"conductivity": field.conductivity, "version": ""}
    return shown | {name: field.stats.get(name) for name in ("unknowns", "iterations")} | cost


def warm_up(name, given, scene, method, **knobs):
    """Load our solvers; a program of others has a process of its own."""
    if method == "grains":
        from studies.peers import beds

        beds.solved(beds.BEDS[scene], 4 if "n" in knobs else None)
    elif method not in MODULES:
        knobs.pop("n", None)
        methods.warm_up(method, **knobs)


def claims(df):
    """What ours owe, what elements of the same mesh agree on, who is cheapest where others get there at all.

    Layers were held to 1e-5 %, and all elements to 1e-6, before values were known.
    """
    yield from _claims(df[df["status"] == "ok"])


def _claims(df):
    for scene, limit in WELL_KNOWN.items():
        mine = df[tables.ours(df) & (df["scene"] == scene) & (df["given"] == "body")]
        if len(mine):
            best = mine.groupby("name")["error_percent"].apply(lambda errors: errors.abs().min()).max()
            yield f"{scene}: the worst of our methods on the body, each at its best, %", best, limit
    for name, apart in same_mesh(df).items():
        limit = PRINTS_SEVEN_DIGITS.get(name, SAME_MESH)
        yield f"{tables.title(name)} and our linear elements on the same mesh, relative", apart, limit
    for scene, ratio in ahead(df).items():
        words = f"{scene}: least CPU time to {AIM:g} % of any other program over ours but for the DEM"
        yield words, None if math.isinf(ratio) else ratio, ">= 1"


def table(df):
    """Errors of the conductivity, % of the known value; CPU time and memory of a solve, median.

    Costs are of the bodies on which they are compared.

    Those of our DEM are without its packing, but for the first row that needs one.
    """
    return tables.lines(df[df["status"] == "ok"])


def sources(df):
    """Programs, what they are given, and how they are installed."""
    return tables.sources(PROGRAMS)


def abilities(df):
    """What each can and cannot: the best |error| of each program on what may be asked, %, of the rows above."""
    return tables.abilities(df)


def notes(df):
    """What each can and cannot; bodies of programs, who gets nowhere; versions, limits, what conventions explain."""
    yield from [abilities.__doc__, markdown(abilities(df))]
    good = df[df["status"] == "ok"]
    bodies = good[~tables.ours(good)].groupby("name")["scene"].nunique()
    yield f"{(bodies >= FEWEST).sum()} of {len(bodies)} programs of others have rows of {FEWEST} bodies or more."
    alone = [scene for scene, ratio in ahead(good).items() if math.isinf(ratio)]
    if alone:
        yield f"No other program here gets to {AIM:g} % of {', '.join(alone)} at the resolutions tried."
    yield from filter(None, [tables.versions(df), *tables.beds(df[df["status"] == "ok"]), *tables.cannot(PROGRAMS)])
