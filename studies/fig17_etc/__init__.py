"""Silica spheres in epoxy: conductivity against volume fraction by all methods, with bounds and an exact witness.

Fig. 17 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799): equal spheres at random in a cube of six
diameters, 0.195 and 1.5 W/(m K). Here all methods have the very same spheres, no two nearer than 0.02 diameters, and
the same boundary conditions: a periodic cell under a mean gradient; or spheres between walls, which no face cuts, under
the gradient and between two isothermal walls, the others insulated. Errors are those against Rayleigh's multipole
method, which is exact to 1e-5 here; between isothermal walls they have none, and errors of the paper's network are
those against the converged voxels. "Converged" is what a method's own rows lead to, with no regard to that value:
voxels and particles extrapolated, of the finite elements the finest mesh. A fifth of spheres at full size is in
`many_inclusions`, on the same cell, and between walls in `fig18_fields`. The paper's network stands here in all its
packings, walls and calibrations, see `studies/common/paper_network.py`, and with the paper's 8e6 particles in periodic
cells, replicas of 125 000.
"""

from importlib import import_module

import numpy as np

from demheat import referee
from demheat.runtime.lazy import lazy_names
from studies.common import paper_network, silica_epoxy
from studies.common.paper_network import NAME
from studies.common.paper_variants import best_variant, parted, worst_error
from studies.fig17_etc.means import all_axes, bounds_of, change, network_errors, walls_less_gradient, witness
from studies.fig17_etc.scenes import FRACTIONS, WALLED
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.pick import pick
from studies.harness.printed import printed

__getattr__, __dir__ = lazy_names(
    __name__, {"studies.fig17_etc.tables": ("notes",), "studies.fig17_etc.figure": ("plot",)}
)

# What rows of the paper's network run; its `NAME` is spelt out, so that others do not change with its module.
MODULES = {"network": "studies.fig17_etc.rows"}
DENSE = 0.5
REALISATIONS = (0, 1, 2)
# Resolutions, coarse to fine, of all methods on the first cell of a fraction, along y. Sizes are in edges of the cube.
RESOLUTIONS = {
    "particles": (30_000, 100_000, 300_000),
    "dem-calibrated": (100_000,),
    "size": (1 / 24, 1 / 48),
    "voxels": (64, 128, 256),
}
# Fractions at which methods are refined; at both ends all of them, between them the scalar scheme's voxels stand for
# those of Eyre and Milton's, and the DEM for finite elements.
REFINED, BETWEEN = (0.1, 0.3, 0.5), ("dem", "dem-calibrated", "fft")
# Fractions whose means are found by multipoles.
MEANS = (0.1, 0.2, 0.3, 0.5)
WITNESS = {"method": "multipole"}
# Particles of the paper's network: in all its variants; and the paper's number, replicas of one packing of the paper's
# own kind, so many along an edge.
NETWORK, MOST, REPLICAS = 150_000, 8_000_000, 4
# Accuracy of the multipoles in the means: a quarter of the least interval of a mean.
ENOUGH = 1e-4
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "converged, off the multipole value": "one limit for all methods and cells, of which the worst has half",
    "worst resolution, off the multipole value": "one limit for all methods, of which the worst has half",
    "what higher degrees would change": "twice the accuracy that they are asked for, of which they end at half",
    "What unequal spheres change": "a tenth of what it might explain; its interval is as wide",
}
# Why claims on the stored rows fail.
FAILS = {
    "worst error of its best variant": (
        "not reproduced with 150000 particles, worst where spheres fill half; with 8e6, as many as the paper has, it is"
    ),
}
PAPER = printed("fig17_etc")
TIMEOUT = 3600.0


def _case(name, kind, boundary, fraction, realisation, axes="y", value=None, **knobs):
    """Case at a value of the method's resolution, or with the knobs that are given."""
    refined = {} if value is None else methods.at(methods.all_methods()[name], value)
    here = {"kind": kind, "boundary": boundary, "fraction": fraction, "realisation": realisation, "axes": axes}
    return methods.case(name, **here, **refined, **knobs)


def _ladder(kind, boundary, fraction):
    """Methods on the first cell: at the first fraction all their resolutions, else those that are extrapolated."""
    first = fraction == FRACTIONS[0]
    for method in methods.compared("dem-calibrated"):
        if _is_refined(method.name, kind, fraction):
            values = methods.spent(method, RESOLUTIONS)
            values = values if first else values[-len(method.terms) - 1 :]
            yield from (_case(method.name, kind, boundary, fraction, 0, value=value) for value in values)
    if boundary == "gradient":
        yield _case("multipole", kind, boundary, fraction, 0)


def _is_refined(name, kind, fraction):
    """Whether a method has rows on the first cell of a fraction; the paper's network has everywhere."""
    if kind == "walled":
        return name in BETWEEN
    if fraction not in REFINED:
        return name == "dem-calibrated"
    # Elements at the least fraction alone: at the largest a minute and a half say what those between walls do.
    return name in BETWEEN or fraction == REFINED[0] or (name, fraction) == ("fft-em", REFINED[-1])


def _means(fraction):
    """Periodic cells of equal spheres, along all axes; where bounds are narrowest, all methods on one of them."""
    here = ("periodic", "gradient", fraction)
    for realisation in REALISATIONS:
        yield {"name": "zeta2", "kind": "periodic", "fraction": fraction, "realisation": realisation} | WITNESS
        if fraction in MEANS:
            yield _case("multipole", *here, realisation, "xyz", accuracy=ENOUGH)
        yield _case("fft", *here, realisation, "xyz", value=128)
    if fraction == FRACTIONS[0]:
        for name, value in (("dem", 100_000), ("fft-em", 128)):
            yield _case(name, *here, 0, "xyz", value=value)


def _cases():
    for fraction in FRACTIONS:
        yield from _ladder("periodic", "gradient", fraction)
        yield from _means(fraction)
    for fraction in REFINED:
        yield from (_case("fft", "unequal", "gradient", fraction, cell, "xyz", value=128) for cell in REALISATIONS)
    for boundary in ("gradient", "walls"):
        yield from _ladder("walled", boundary, WALLED)
    yield from paper_network.once(NETWORK)
    yield from paper_network.cases([MOST], held=["periodic"], packings=["lsa"], seeds=[0], replicas=REPLICAS)


CASES = list(_cases())


def QUICK(case):
    """Two periodic cells with a tenth of spheres; on one of them all methods at their coarsest."""
    if case["name"] == NAME:
        return False
    if case["fraction"] > FRACTIONS[0] or case["kind"] != "periodic" or case["realisation"] > 1:
        return False
    if case["name"] in ("multipole", "zeta2"):
        return True
    if case.get("axes") == "xyz":
        return case["name"] == "fft"
    method = methods.all_methods()[case["name"]]
    coarsest = methods.at(method, methods.spent(method, RESOLUTIONS)[0])
    return method.role == "main" and case["realisation"] == 0 and coarsest.items() <= case.items()


def VALUES(case):
    """All but the ladders on one cell of the largest fraction, whose costs are shown."""
    return case["name"] in (NAME, "zeta2") or case.get("axes") != "y" or case["fraction"] != FRACTIONS[-1]


def run(name, kind=None, fraction=None, realisation=None, boundary="gradient", axes="y", *, method, **knobs):
    """Solve one dispersion along some axes, or find its zeta_2; by the paper's network all first cells."""
    if method in MODULES:
        return import_module(MODULES[method]).network_row(**knobs)
    made = [silica_epoxy.scene(kind, fraction, seed=realisation, axis="xyz".index(a), boundary=boundary) for a in axes]
    if name == "zeta2":
        return {"zeta2": methods.load(method).zeta2(made[0], order=ORDER), "number": len(made[0].inclusions)}
    rows = [silica_epoxy.solved(scene, method=method, **knobs)[1] for scene in made]
    return silica_epoxy.together(rows, axes)


# zeta_2 to some 1e-6 with gaps of 0.02 diameters: terms fall as (1/2.04)^(2 order).
ORDER = 12


def warm_up(name, kind=None, fraction=None, realisation=None, boundary="gradient", axes="y", *, method, **knobs):
    """Make the dispersion and the packing, load and compile."""
    made = silica_epoxy.scene(kind, fraction, seed=realisation, boundary=boundary)
    if "particles" in knobs:
        from demheat.packing.cache import relaxed

        relaxed(knobs["particles"], size=made.size, periodic=made.periodic, seed=knobs["seed"])
    methods.warm_up(method, **knobs)


def claims(df):
    """All methods on the same spheres; boundary conditions; means and their bounds.

    Converged values of all methods are held to the same 0.1 % of the multipoles, below the standard deviation between
    cells, so that methods can be compared; to 0.15 % in dense cells, and to 0.5 % at the worst resolution.
    """
    network, df = _network(df), parted(df)[1]
    yield from [*_one_arrangement(df), *_boundaries(df), *_averages(df), *network]


def _network(df):
    """The paper's own network in the paper's measure, which it prints for 8e6 particles."""
    made = network_errors(df, "gradient")
    if made:
        best = best_variant(made)
        text = f"The paper's network, {best[1]} particles, periodic cells: worst error of its best variant, % "
        text += f"(the paper prints {PAPER['dem_fft']:g} between its DEM of 8e6 and its FFT)"
        yield text, worst_error(made[best]), PAPER["dem_fft"]
    # The paper's own packings; relaxed ones have no rows of so many.
    full = [found for (_, number), found in made.items() if number == MOST]
    text = f"The paper's network, {MOST} particles as in the paper, periodic cells: largest error at any fraction, %"
    yield text, max(map(worst_error, full), default=None), PAPER["dem_fft"]


def _one_arrangement(df):
    """Each method beside the witness on the very same spheres."""
    for kind in ("periodic", "walled"):
        for fraction in FRACTIONS:
            exact = witness(df, kind, fraction)
            if exact is None:
                continue
            where = f"f = {fraction:g}, {kind}: "
            here = {"kind": kind, "boundary": "gradient", "fraction": fraction, "realisation": 0, "axes": "y"}
            for method in methods.compared():
                found = converged(df, method.name, **here)
                off = None if found is None else 100 * abs(referee.value_error(found, exact))
                # A dense cell has gaps in which no method is fine enough.
                limit = 0.15 if fraction >= DENSE else 0.1
                yield f"{where}{method.title}, converged, off the multipole value, %", off, limit
    yield from _dem_and_fft(df)
    exact = witness(df, "periodic", FRACTIONS[0])
    for method in methods.compared():
        rows = pick(df, name=method.name, kind="periodic", fraction=FRACTIONS[0], realisation=0, axes="y")
        if len(rows):
            off = 100 * abs(referee.value_error(rows["k_ratio"], exact)).max(skipna=False)
            yield f"f = {FRACTIONS[0]:g}: {method.title}, worst resolution, off the multipole value, %", off, 0.5
    left = 100 * pick(df, name="multipole", axes="y")["truncation"].max(skipna=False)
    yield "Multipoles: what higher degrees would change, by their own estimate, %", left, 0.002


def _dem_and_fft(df):
    """The paper's own measure, without a witness: a tenth of what it prints."""
    here = {"kind": "periodic", "boundary": "gradient", "realisation": 0, "axes": "y"}
    pairs = [[converged(df, name, fraction=f, **here) for name in ("dem", "fft")] for f in REFINED]
    off = [100 * abs(referee.value_error(dem, fft)) for dem, fft in pairs if dem and fft]
    text = f"DEM against FFT, converged, largest of {len(REFINED)} fractions, % (the paper prints {PAPER['dem_fft']:g})"
    yield text, max(off) if len(off) == len(REFINED) else None, PAPER["dem_fft"] / 10


def _boundaries(df):
    """Isothermal walls less mean gradient, on the same spheres, by each method."""
    found = [walls_less_gradient(df, method.name, WALLED) for method in methods.compared()]
    found = [each for each in found if each is not None]
    if len(found) > 1:
        text = f"f = {WALLED:g}: difference of the boundary conditions, by one method less by another, % of k"
        yield text, np.max(found) - np.min(found), 0.05


def _averages(df):
    """Means over axes and realisations: bounds, and the deviation between cells beside that between methods."""
    for (fraction, name), rows in all_axes(df).groupby(["fraction", "name"]):
        limits = np.array([bounds_of(df, row) for _, row in rows.iterrows()])
        k = rows["k_ratio"].to_numpy(dtype=float)
        room = 100 * np.minimum(referee.value_error(k, limits[:, 0]), -referee.value_error(k, limits[:, 1]))
        text = f"f = {fraction:g}, {methods.all_methods()[name].title}, means over three axes: "
        yield text + "least room to the third-order bounds of the same cell, %", np.min(room), ">= 0"
    changed = [change(df, fraction, "unequal") for fraction in REFINED]
    if None not in changed:
        # The paper puts its gap to experiment down to this and to its perfect interfaces.
        text = f"What unequal spheres change in the mean over cells, largest of {len(REFINED)} fractions, % "
        text += f"(the paper is {PAPER['dem_experiment']:g} off experiment)"
        yield text, np.max(np.abs(changed)), PAPER["dem_experiment"] / 10


def table(df):
    """Errors, in % of the multipole value, on one cell of each fraction, along one axis; and k/k_m.

    "Converged" is extrapolated from the method's own finest rows, of FEM the finest itself. Standard
    deviations between cells are of means over three axes, or along one, % of k; the mean's 95 % interval is from
    Student's distribution. Costs are those of the densest of these cells, the packing from the cache.
    """
    from studies.fig17_etc.tables import lines

    return lines(parted(df)[1])
