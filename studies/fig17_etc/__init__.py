"""Silica spheres in epoxy: conductivity against volume fraction by all methods, with bounds and an exact witness.

Fig. 17 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799): equal spheres at random in a cube of six
diameters, 0.195 and 1.5 W/(m K). Here all methods have the very same spheres, no two nearer than 0.02 diameters, and
the same boundary conditions: a periodic cell under a mean gradient; or spheres between walls, which no face cuts, under
the gradient and between two isothermal walls, the others insulated. Errors are those against Rayleigh's multipole
method, which is exact to 1e-5 here; between isothermal walls they have none, and errors of the paper's network are
those against the converged voxels. "Converged" is what a method's own rows lead to, with no regard to that value:
voxels and particles extrapolated, of the finite elements the finest mesh. The paper's network stands here in all its
packings, walls and calibrations, see `studies/common/paper_network.py`; the paper's figure has 8e6 particles, as has
`many_inclusions`.
"""

import numpy as np

from demheat import referee
from studies.common import paper_network, silica_epoxy
from studies.common.paper_network import NAME, unscaled
from studies.common.paper_variants import parted
from studies.fig17_etc.means import all_axes, bounds_of, change, walls_less_gradient, witness
from studies.harness import methods
from studies.harness.converged import converged
from studies.harness.pick import pick, present
from studies.harness.store import printed

FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
DENSE = 0.5
REALISATIONS = (0, 1, 2, 3, 4)
# Resolutions, coarse to fine, of all methods on the first cell of a fraction, along y. Sizes are in edges of the cube.
RESOLUTIONS = {
    "particles": (30_000, 100_000, 300_000),
    "dem-calibrated": (100_000,),
    "size": (1 / 24, 1 / 48),
    "voxels": (64, 128, 256),
}
# Fractions at which the boundary conditions are compared; at the first, finite elements see all axes.
WALLED = (0.2, 0.4)
# At L/24, and at the three sizes tried instead, gmsh divides opposite faces of this cell unlike each other: refused.
UNMESHED = ("fem", "periodic", 0.4)
WITNESS = {"method": "multipole"}
NETWORK = 150_000  # particles of the paper's network
# Accuracy of the multipoles in the means: a tenth of the least interval of a mean.
ENOUGH = 1e-4
PAPER = printed("fig17_etc")
TIMEOUT = 3600.0


def _case(name, kind, boundary, fraction, realisation, axes="y", value=None, **knobs):
    """Case at a value of the method's resolution, or with the knobs that are given."""
    refined = {} if value is None else methods.at(methods.found()[name], value)
    here = {"kind": kind, "boundary": boundary, "fraction": fraction, "realisation": realisation, "axes": axes}
    return methods.case(name, **here, **refined, **knobs)


def _ladder(kind, boundary, fraction):
    """All methods at all their resolutions; what is extrapolated needs no coarser ones between walls."""
    for method in methods.compared("dem-calibrated"):
        values = methods.spent(method, RESOLUTIONS)
        if (method.name, kind, fraction) == UNMESHED:
            values = values[1:]
        values = values if kind == "periodic" else values[-len(method.terms) - 1 :]
        yield from (_case(method.name, kind, boundary, fraction, 0, value=value) for value in values)
    if boundary == "gradient":
        yield _case("multipole", kind, boundary, fraction, 0)


def _means(fraction):
    """Periodic cells of equal spheres, along all axes; all methods on one of them."""
    here = ("periodic", "gradient", fraction)
    for realisation in REALISATIONS:
        yield {"name": "zeta2", "kind": "periodic", "fraction": fraction, "realisation": realisation} | WITNESS
        yield _case("multipole", *here, realisation, "xyz", accuracy=ENOUGH)
        yield _case("fft", *here, realisation, "xyz", value=128)
    yield _case("dem", *here, 0, "xyz", value=100_000)
    yield _case("fft-em", *here, 0, "xyz", value=128)
    if fraction == WALLED[0]:
        yield _case("fem", *here, 0, "xyz", value=1 / 24)


def _cases():
    for fraction in FRACTIONS:
        yield from _ladder("periodic", "gradient", fraction)
        yield from _means(fraction)
        yield from (_case("fft", "unequal", "gradient", fraction, cell, "xyz", value=128) for cell in REALISATIONS)
    for fraction in WALLED:
        for boundary in ("gradient", "walls"):
            yield from _ladder("walled", boundary, fraction)
            yield from (_case("fft", "walled", boundary, fraction, cell, "xyz", value=128) for cell in REALISATIONS)
    yield from paper_network.cases([NETWORK])


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
    method = methods.found()[case["name"]]
    coarsest = methods.at(method, methods.spent(method, RESOLUTIONS)[0])
    return method.role == "main" and case["realisation"] == 0 and coarsest.items() <= case.items()


def run(name, kind=None, fraction=None, realisation=None, boundary="gradient", axes="y", *, method, **knobs):
    """Solve one dispersion along some axes, or find its zeta_2; by the paper's network the first of each fraction."""
    if name == NAME:
        return _network(**knobs)
    made = [silica_epoxy.scene(kind, fraction, seed=realisation, axis="xyz".index(a), boundary=boundary) for a in axes]
    if name == "zeta2":
        from references import multipole

        return {"zeta2": multipole.zeta2(made[0], order=ORDER), "number": len(made[0].inclusions)}
    rows = [silica_epoxy.solved(scene, method=method, **knobs)[1] for scene in made]
    return silica_epoxy.together(rows, axes)


def _scenes(held):
    """First cells by their fraction: periodic ones, or those between isothermal walls."""
    kind, boundary = ("periodic", "gradient") if held == "periodic" else ("walled", "walls")
    some = FRACTIONS if held == "periodic" else WALLED
    return {f"{fraction:g}": silica_epoxy.scene(kind, fraction, seed=0, boundary=boundary) for fraction in some}


def _network(packing, held, particles, seed):
    scenes = _scenes(held)
    made = paper_network.packed(scenes["0.2"].size, packing, held, particles, seed)
    fields, row = paper_network.solved(scenes, made, held)
    return row | {f"k_{where}": unscaled(field, silica_epoxy.EPOXY.conductivity) for where, field in fields.items()}


# zeta_2 to some 1e-6 with gaps of 0.02 diameters: terms fall as (1/2.04)^(2 order).
ORDER = 12


def warm_up(name, kind=None, fraction=None, realisation=None, boundary="gradient", axes="y", *, method, **knobs):
    """Make the dispersion and the packing, load and compile."""
    if name == NAME:
        paper_network.packed(_scenes(knobs["held"])["0.2"].size, **knobs)
        paper_network.warm_up(knobs["held"])
        return
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
    df = parted(df)[1]
    yield from present([*_one_arrangement(df), *_boundaries(df), *_averages(df)])


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
    """The paper's own measure, without a witness: a fifth of what it prints."""
    here = {"kind": "periodic", "boundary": "gradient", "realisation": 0, "axes": "y"}
    pairs = [[converged(df, name, fraction=f, **here) for name in ("dem", "fft")] for f in FRACTIONS]
    off = [100 * abs(referee.value_error(dem, fft)) for dem, fft in pairs if dem and fft]
    text = f"DEM against FFT, converged, largest of any fraction, % (the paper prints {PAPER['dem_fft']:g})"
    yield text, max(off) if len(off) == len(FRACTIONS) else None, PAPER["dem_fft"] / 5


def _boundaries(df):
    """Isothermal walls less mean gradient, on the same spheres, by each method."""
    for fraction in WALLED:
        found = [walls_less_gradient(df, method.name, fraction) for method in methods.compared()]
        found = [each for each in found if each is not None]
        if len(found) > 1:
            spread = np.max(found) - np.min(found)
            text = f"f = {fraction:g}: difference of the boundary conditions, by one method less by another, % of k"
            yield text, spread, 0.06


def _averages(df):
    """Means over axes and realisations: bounds, and the deviation between cells beside that between methods."""
    for (fraction, name), rows in all_axes(df).groupby(["fraction", "name"]):
        limits = np.array([bounds_of(df, row) for _, row in rows.iterrows()])
        k = rows["k_ratio"].to_numpy(dtype=float)
        room = 100 * np.minimum(referee.value_error(k, limits[:, 0]), -referee.value_error(k, limits[:, 1]))
        text = f"f = {fraction:g}, {methods.found()[name].title}, means over three axes: "
        yield text + "least room to the third-order bounds of the same cell, %", np.min(room), ">= 0"
    for fraction in FRACTIONS:
        changed = change(df, fraction, "unequal")
        # Half of the gap to experiment that the paper puts down to this and to its perfect interfaces.
        text = f"f = {fraction:g}: what unequal spheres change in the mean over cells, %"
        yield text, changed if changed is None else abs(changed), PAPER["dem_experiment"] / 2


def table(df):
    """Errors, in % of the multipole value, on one cell of each fraction, along one axis; and k/k_m.

    "Converged" is extrapolated from the method's own finest rows, of FEM the finest itself. Standard
    deviations between cells are of means over three axes, or along one, % of k; the mean's 95 % interval is from
    Student's distribution. Costs are those at f = 0.4, the packing from the cache.
    """
    from studies.fig17_etc.tables import lines

    return lines(parted(df)[1])


def notes(df):
    """The variants of the paper's network."""
    from studies.fig17_etc.tables import told

    return told(df)


def plot(df):
    """k, and k over Maxwell's, with bounds and estimates; errors; deviations between cells; the network's variants."""
    from studies.fig17_etc.figure import draw

    return draw(df)
