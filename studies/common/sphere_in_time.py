"""The sphere of Haddad et al. (2021), figures 7 and 8: its scene, its cases, and what a march in time gives.

Eqs. 18-19 as printed swap the initial and the surface temperature and lose the radius; the referee is the corrected
series, `references.series`.
"""

import numpy as np

from demheat.scene import Material, Scene
from studies.harness import methods
from studies.harness.cost import measured

DIAMETER, COLD, HOT = 0.1, 20.0, 200.0
METAL = Material(185.0, density=2700.0, heat_capacity=900.0)
CENTER = np.full((1, 3), DIAMETER / 2)
# Of figure 7, s.
CENTER_TIMES = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 15.0, 20.0, 25.0, 30.0)

NUMBERS = (1_000, 3_000, 10_000, 30_000, 100_000, 1_000_000)
# The laws of contacts, up to the paper's number of elements.
CONTACTS, PAPERS = ("calibrated", "platonic"), 100_000
CONTACT_NUMBERS = (1_000, 3_000, 10_000, PAPERS)
# Longest edges, m; the last linear ones are some 1e5 tetrahedra, as in the paper.
SIZES = {1: (0.008, 0.005, 0.00276), 2: (0.012, 0.008, 0.005)}
# Temporal errors far below the spatial ones: of the whole march, and of each of some 200 steps.
ACCURACY = {"dem": 1e-5, "fem": 2e-6}


def sphere():
    """Sphere at 20 C, its surface at 200 C from time 0 on."""
    return Scene(size=(DIAMETER,) * 3, matrix=METAL, domain="sphere", walls={"round": HOT}, initial=COLD)


def cases():
    """DEM packings, more of the small ones, of all laws; finite elements."""
    dem = {"method": "dem"}
    for number in NUMBERS:
        for seed in range(3 if number < 100_000 else 2 if number == 100_000 else 1):
            yield {"law": "laguerre", "particles": number, "seed": seed} | dem
    for number in NUMBERS:
        # Of the laws of contacts, a few per cent off, every second number.
        for law in CONTACTS if number in CONTACT_NUMBERS else ():
            yield from (
                {"law": law, "particles": number, "seed": seed} | dem for seed in range(3 if number < 30_000 else 1)
            )
    for order, sizes in SIZES.items():
        yield from ({"order": order, "size": size, "method": "fem"} for size in sizes)


def quick(case):
    """Two packings each of 1000 and 3000, one for the laws of contacts, and the coarsest meshes."""
    if "size" in case:
        return case["size"] == SIZES[case["order"]][0]
    return case["particles"] <= 3_000 and case["seed"] < (2 if case["law"] == "laguerre" else 1)


def packing_of(particles, seed):
    """Packing in the sphere, kept in the cache."""
    from demheat.packing.cache import relaxed

    return relaxed(particles, size=sphere().size, periodic=False, domain="sphere", seed=seed)


def marched(times, look, *, method, **knobs):
    """March to the times by a method, and read something off each Field."""
    from references import series

    if "particles" in knobs:
        knobs = {**knobs, "packing": packing_of(knobs.pop("particles"), knobs.pop("seed"))}
    scene, row, stats = sphere(), {}, {}
    knobs = {"accuracy": ACCURACY[method]} | knobs

    def march():
        fields = methods.load(method).evolve(scene, times, **knobs)
        for field, exact in zip(fields, series.evolve(scene, times, points_per_axis=1), strict=True):
            row.update(look(field, exact))
            stats.update(field.stats)

    _, cost = measured(march)
    names = ("elements", "integrator", "steps", "spectral_ratio", "energy_error", "unknowns", "iterations", "residual",
             "calibration")  # fmt: skip
    return row | {name: stats.get(name) for name in names} | {"packing_cached": stats.get("cached")} | cost


def prepare(times, look, *, method, **knobs):
    """Make and keep the packing, load and compile: nothing of it is part of what is compared."""
    if "particles" in knobs:
        packing = packing_of(knobs["particles"], knobs["seed"])
        if knobs["law"] == "calibrated":
            from demheat.dem.calibration import cube_like

            cube_like(packing)
    marched(times, look, method=method, **{**knobs, **methods.small(method)})


def radii(points):
    """Distance from the centre, in radii of the sphere."""
    return np.linalg.norm(points - CENTER, axis=1) / (DIAMETER / 2)


def in_shells(r, values, weights, shells=20):
    """Weighted mean and largest size of values in shells of equal thickness; not-a-number in empty ones."""
    place = np.minimum((r * shells).astype(int), shells - 1)
    weight, total = (np.bincount(place, w, shells) for w in (weights, weights * values))
    largest = np.full(shells, -np.inf)
    np.maximum.at(largest, place, np.abs(values))
    empty = weight == 0
    mean = np.divide(total, weight, out=np.full(shells, np.nan), where=~empty)
    return (np.arange(shells) + 0.5) / shells, mean, np.where(empty, np.nan, largest)


def slice_grid(n=41):
    """Points of a grid over the plane z = R that lie in the sphere, and their mask: see `terminal.slices.plane`."""
    from demheat.terminal.slices import plane

    return plane(sphere(), axis=2, at=DIAMETER / 2, n=n)


def name_of(row):
    """What a row is, in words without its resolution."""
    return f"DEM, {row['law']}" if row["method"] == "dem" else f"FEM, P{row['order']:.0f}"


def solved(df):
    """Rows that have numbers, the refused ones left out, each with its name."""
    rows = df[df["status"] == "ok"]
    return rows.assign(name=[name_of(row) for _, row in rows.iterrows()])


def order_of(rows, column):
    """Order in the particle spacing of a column's mean over packings."""
    means = rows.groupby("particles")[column].agg(lambda errors: errors.mean(skipna=False))
    return -3 * np.polyfit(np.log(means.index), np.log(means), 1)[0]


def balance(df):
    """Claims on heat: the network's steps keep it to rounding, the elements' to ten times their linear tolerance."""
    for method, limit in (("dem", 1e-12), ("fem", 1e-8)):
        lost = df[df["method"] == method]["energy_error"].max(skipna=False)
        yield f"{method}: largest heat lost over heat moved", lost, limit
