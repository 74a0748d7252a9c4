"""Temperature and flux among 83 spheres, point by point: DEM, FEM and FFT against multipoles.

Table 3 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799): silica spheres in epoxy (0.195 and 1.5 W/(m K)),
a fifth of a cube of six diameters, 25 C at y = 0 and 35 C at y = L, the other faces insulated. Their arrangement is not
published, so their numbers and ours differ; what can be compared is how far methods differ on one arrangement. Here the
same spheres, none of which crosses a face and no two nearer than 0.02 diameters, the first of the arrangements drawn
(seed 20) in which the paper's four points keep away from interfaces, are under two loads: "walls", as in the paper, and
"gradient", in a periodic cell under the same mean gradient. Both have an exact witness, the multipole method: the
walled box is an eighth of a periodic cell of its mirror images.

Temperatures are in % of the span of 10 K, the flux is unsigned. All points lie on the plane x = L/2, sampled at
51 x 51 points, and drawn at 200 x 200. "Away" is more than the mean diameter of 1e5 particles, 0.021 L, from interfaces
and insulated faces; the band is the rest. In the periodic cell, where the level of temperature is free, the plane's
mean is 30 C.

The paper's network is sampled as there: its flux is that of the particles, averaged over halos of 11 mean radii (eqs.
22-23), which end at walls and not at interfaces. It stands here in all its packings, walls and calibrations (see
`studies/common/paper_network.py`), and in the periodic cell with the paper's 8e6 particles, replicas of 125 000.
"""

from importlib import import_module

from demheat import referee
from studies.common import paper_network
from studies.common.paper_network import NAME
from studies.common.paper_network import cases as network_cases
from studies.common.paper_variants import parted
from studies.fig18_fields.tables import COMPARED
from studies.harness import methods
from studies.harness.methods import EDGE, resolution
from studies.harness.pick import pick
from studies.harness.printed import printed

# What rows of the paper's network run; its `NAME` is spelt out, so that others do not change with its module.
MODULES = {"dispersion": "demheat.packing.dispersion", "network": "studies.fig18_fields.network"}
BOUNDARIES = ("gradient", "walls")
NUMBERS = (30_000, 100_000, 300_000)
# Longest edges, in edges of the cube.
SIZES = {"fem": (0.06, 0.015)}
VOXELS = (64, 128, 256)
# Finite elements are compared in the paper's own box only.
AMONG = {"gradient": [each for each in COMPARED if each != "fem"], "walls": COMPARED}
RESOLUTIONS = {"particles": NUMBERS, "size": SIZES["fem"], "voxels": VOXELS}
# Of the paper's network: under all kinds of walls; and the paper's number in the periodic cell, replicas of one packing
# of the paper's own kind, so many along an edge.
NETWORK, MOST, REPLICAS = 150_000, 8_000_000, 4
DEGREES = {"gradient": (8, 14), "walls": (6, 9)}
# Between walls these rows keep pictures of many pixels.
DRAWN = {
    "multipole": {"order": DEGREES["walls"][-1]},
    "dem": {"particles": NUMBERS[-1]},
    "fem": {"size": SIZES["fem"][-1] * EDGE},
    "fft": {"voxels": VOXELS[-1]},
    "network": {"particles": NETWORK, "held": "center", "packing": "lsa", "seed": 0},
}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "Multipoles of degree": "one limit for both loads, of which the lower degrees have half",
    "temperature off the multipoles": "one limit for all methods, of which the voxels have half",
    "flux off the multipoles": "one limit for all methods, of which the voxels have half",
    "temperature, % of the span": "that of each method beside the witness",
    "flux, % of": "a third of what the paper's two methods differ by; of its network all of it",
    "temperature, % of degrees Celsius": "a tenth of what the paper prints; of its network all of it",
    "conductivity off the multipoles'": "the paper's own number is the limit",
}
FAILS = {
    "FFT, 64^3 voxels": (
        "at C, whose flux is the least, fits of 64^3 voxels are 2.7 % off; over the plane they are twice as near as "
        "interpolation, for which the limit was set (1.8 % at C)"
    ),
}
PAPER = printed("fig18_fields")
TIMEOUT = 3600.0


def _cases():
    yield {"name": "arrangement", "method": "dispersion"}
    for boundary in BOUNDARIES:
        yield from (methods.case("multipole", boundary=boundary, order=degree) for degree in DEGREES[boundary])
        for method in methods.compared():
            if method.name in AMONG[boundary]:
                knobs = [methods.at(method, value) for value in methods.spent(method, RESOLUTIONS)]
                yield from (methods.case(method.name, boundary=boundary, **each) for each in knobs)
    yield from paper_network.once(NETWORK)
    yield from network_cases([MOST], held=["periodic"], packings=["lsa"], seeds=[0], replicas=REPLICAS)


CASES = list(_cases())
# What such solves cost is in `many_inclusions`.
VALUES = True


def QUICK(case):
    """Each method at its coarsest; between walls the finite elements stand in for the multipoles of 664 images."""
    if case["name"] == "multipole":
        return (case["boundary"], case["order"]) == ("gradient", DEGREES["gradient"][0])
    if case["name"] in ("arrangement", NAME):
        return case["name"] != NAME
    method = methods.all_methods()[case["name"]]
    coarsest = methods.at(method, methods.spent(method, RESOLUTIONS)[0])
    return coarsest.items() <= case.items() and method.role == "main"


def run(name, boundary=None, *, method, **knobs):
    """Where the points lie; or the field of one method under one load."""
    from studies.fig18_fields import rows as fig18_rows

    if name == "arrangement":
        return fig18_rows.arrangement_row()
    if method in MODULES:
        return import_module(MODULES[method]).network_row(**knobs, fine=_is_drawn(name, **knobs))
    return fig18_rows.field_row(boundary, method=method, **knobs, fine=_is_drawn(name, boundary, **knobs))


def _is_drawn(name, boundary="walls", **knobs):
    """The finest row of each method between walls, and the paper's network as the paper has it."""
    return boundary == "walls" and name in DRAWN and DRAWN[name].items() <= knobs.items()


def claims(df):
    """The witnesses' own error; each method at points and on the plane; what the paper prints, in its own measure.

    The finest rows of all methods are held to the same 0.03 % of the span and 1 % of the local flux, a third of what
    the paper's two methods differ by in its table, 3.1 %. The paper's measure of a temperature is in degrees Celsius.
    """
    from studies.fig18_fields.errors import network_errors, with_errors

    others = parted(df)[1]
    found = with_errors(others)
    claimed = [*_witnesses(others), *_methods(found), *_side_by_side(found)]
    yield from [*claimed, *_network(network_errors(df), found)]


def _witnesses(df):
    """What the multipoles of the highest degree may be off: by how much a lower degree differs."""
    for boundary in BOUNDARIES:
        few, many = (pick(df, name="multipole", boundary=boundary, order=degree) for degree in DEGREES[boundary])
        if not len(few) or not len(many):
            continue
        few, many = few.iloc[0], many.iloc[0]
        degrees = " against ".join(map(str, DEGREES[boundary]))
        text = f"Multipoles of degree {degrees}, {boundary}, worst point of Table 3: "
        warm, flux = _differences(few, many)[:2]
        yield text + "temperature, % of the span", warm, 0.02
        yield text + "flux, % of the local one", flux, 0.3


def _differences(row, other):
    """Largest differences of two rows at the points: temperature, % of the span; flux, % of the other's; degrees, %."""
    from studies.fig18_fields.errors import at_points

    found = at_points(row, other)
    return found["worst_T"], found["worst_q"], found["worst_celsius"]


def _methods(found):
    """Each method against the witness: quick rows at the coarsest resolution, full ones at the finest.

    Limits of quick rows are some twice what was found; where their witness is a coarse FEM, itself 2 % off, those of
    the flux are twice as large again. Nothing is claimed of the flux by coarse particles: they are 0.03 L, as far as
    a point is from an interface, and their flux was found 9 % off on this arrangement, 1 to 2 % on another.
    """
    for name, knob, coarse, fine, quick in (
        ("dem", "particles", NUMBERS[0], NUMBERS[-1], {"gradient": (0.15, None), "walls": (0.3, None)}),
        ("fem", "size", None, SIZES["fem"][-1] * EDGE, {}),
        ("fft", "voxels", VOXELS[0], VOXELS[-1], {"gradient": (0.15, 2.0), "walls": (0.15, 2.0)}),
    ):
        for boundary in BOUNDARIES:
            exact = len(pick(found, name="multipole", boundary=boundary)) > 0
            if name == "fem" and not exact:
                continue  # it is the witness itself
            whom = "the multipoles" if exact else "a coarse FEM that is 2 % off itself"
            for size, limits in ((coarse, quick.get(boundary, (None, None))), (fine, (0.03, 1.0))):
                if size is None:
                    continue
                rows = pick(found, name=name, boundary=boundary, **{knob: size})
                words = resolution({"name": name, knob: size})
                text = f"{name.upper()}, {words}, {boundary}, worst point of Table 3: "
                yield text + f"temperature off {whom}, % of the span", _worst(rows, "worst_T"), limits[0]
                if limits[1] is None:
                    continue
                limit = limits[1] if exact else 2 * limits[1]
                yield text + f"flux off {whom}, % of the local one", _worst(rows, "worst_q"), limit


def _worst(rows, column):
    return rows[column].max(skipna=False) if len(rows) else None


def _side_by_side(found):
    """DEM against FEM with no third one between them, each at its finest; what the paper compares."""
    dem = pick(found, name="dem", boundary="walls", particles=NUMBERS[-1])
    fem = pick(found, name="fem", boundary="walls", size=SIZES["fem"][-1] * EDGE)
    if not len(dem) or not len(fem):
        return
    text = f"DEM, {NUMBERS[-1]} particles, against FEM, P2, walls, worst point of Table 3: "
    warm, flux, celsius = _differences(dem.iloc[0], fem.iloc[0])
    yield text + "temperature, % of the span", warm, 0.03
    yield text + "flux, % of FEM's", flux, 1.0
    # A tenth of what the paper prints.
    within = PAPER["within_temperature"]
    yield text + f"temperature, % of degrees Celsius (the paper prints {within:g})", celsius, within / 10


def _network(made, found):
    """The paper's network of as many elements as the paper has, against what is exact, by the paper's own measures."""
    exact = pick(found, name="multipole", boundary="gradient", order=DEGREES["gradient"][-1])
    rows = pick(made, particles=MOST) if len(made) else made
    if not len(rows) or not len(exact):
        return
    off = [_differences(row, exact.iloc[0]) for _, row in rows.iterrows()]
    text = f"The paper's network, {MOST} particles, halos of 11 mean radii, against the multipoles, gradient, "
    text += "worst point of Table 3: "
    within = PAPER["within_temperature"]
    yield text + f"temperature, % of degrees Celsius (the paper prints {within:g})", min(w[2] for w in off), within / 10
    # Its temperatures are a tenth of that off, as those of ours. Of the flux its text says 3 %, its table 3.1.
    yield text + "flux, % of theirs (the paper's table: 3.1)", min(w[1] for w in off), 3.1
    # The printed 0.5 % is between its network of as many elements and FFT of 512^3, on other spheres.
    k = abs(referee.value_error(rows["k"] * rows["ct_cell"], exact["k_ratio"].iloc[0])).max(skipna=False)
    text = f"The paper's network, {MOST} particles, gradient: conductivity off the multipoles', %"
    yield text, 100 * k, PAPER["dem_fft"]


def table(df):
    """Temperature, C, and size of the flux, W/m2, at the points of Table 3, and errors against the first of each load.

    `T off` and `q off` are the worst of the four points, % of the span and % of the local flux; `T rms`, `T max` (% of
    the span) and the flux's (size of the vector's error, % of the mean flux) are over the plane, away from interfaces
    and insulated faces and in the band along them. The printed values are of another arrangement, which is not
    published. Costs are those of the solve with packings from the cache.
    """
    import pandas as pd

    from studies.fig18_fields.errors import with_errors
    from studies.fig18_fields.tables import lines

    shown = parted(df[df["status"] == "ok"])[1]
    return pd.DataFrame(lines(shown, with_errors(shown), PAPER))


def notes(df):
    """The paper's network in all its variants; where the points lie, and how many elements there are."""
    from studies.fig18_fields.tables import told

    return told(df[df["status"] == "ok"], PAPER)


def plot(df):
    """Fields on the plane and what methods are off there; errors at the points; errors over unknowns."""
    from studies.fig18_fields.figure import draw

    return draw(df[df["status"] == "ok"], PAPER)
