"""Temperature and flux inside a sphere and around it, point by point: DEM, FEM and FFT against the exact field.

Figures 15 and 16 and Table 2 of Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799): a sphere of radius L/3 in a
cube, five times as conductive, 25 C at y = 0 and 35 C at y = L, the other faces insulated. The exact field is that of
the simple cubic array by Rayleigh's multipoles. Errors of the flux are the size of the vector's, in % of the exact mean
flux, those of temperature in % of the span of 10 K, at the 200 x 200 middles of pixels of the plane z = L/2; at the
points of Table 2, in % of the exact flux there and in K.

"Away" is more than a mean particle diameter of a packing of 1.5e5, 0.0187 L, from the interface and from the insulated
faces, the same for all methods; the band is the rest. The paper's network is sampled as there: its flux is that of the
particles (eq. 20) averaged over halos of 4 or 11 mean radii (eqs. 22-23), which do not stop at the interface.
"""

from demheat import referee
from demheat.gallery import sphere_in_cube
from studies.fig15_16_fields.tables import error_columns, largest
from studies.harness import methods
from studies.harness.pick import order, pick, present
from studies.harness.store import printed

# Table 2, in edges of the cube.
POINTS = {"A": (0.5, 0.5, 0.5), "B": (0.08, 0.5, 0.5), "C": (0.5, 0.92, 0.5)}
PLANE = {"axis": 2, "at": 0.05}
GRID, PICTURE = 200, 61
NUMBERS, PAPERS, MOST = (10_000, 50_000, 150_000), 150_000, 500_000
SEEDS = (0, 1, 2)
RATIOS = (4.0, 11.0)
# Longest edges, m. Linear elements of 3.5 mm are some 1e5 tetrahedra, as in the paper.
SIZES = {"fem-p1": (0.006, 0.0035), "fem": (0.01, 0.006, 0.004, 0.003)}
VOXELS = (32, 64, 128)
PAPER = printed("fig15_16_fields")
# Rayleigh's method, McPhedran and McKenzie (1978), summed elsewhere: W/m2 and C, to the digits given.
RAYLEIGH = {"q_A": (7767.43, 2), "q_B": (2309.24, 2), "q_C": (6433.60, 2), "T_C": (33.511132, 6)}


def _cases():
    yield methods.case("exact")
    for number in (*NUMBERS, MOST):
        for seed in SEEDS if number == NUMBERS[0] else SEEDS[:1]:
            yield methods.case("dem", particles=number, seed=seed)
            for ratio in RATIOS:
                yield methods.case("dem-calibrated", particles=number, seed=seed, ratio=ratio)
            if number < MOST:
                yield methods.case("dem-plain", particles=number, seed=seed)
    for name, sizes in SIZES.items():
        yield from (methods.case(name, size=size) for size in sizes)
    yield from (methods.case("fft", voxels=voxels) for voxels in VOXELS)


CASES = list(_cases())


def QUICK(case):
    """The exact field, one packing of 1e4, the coarsest quadratic elements and voxels."""
    coarsest = {"particles": NUMBERS[0], "size": SIZES["fem"][0], "voxels": VOXELS[0]}
    fits = all(case[key] == value for key, value in coarsest.items() if key in case)
    return fits and case["name"] not in ("dem-plain", "fem-p1") and not case.get("seed")


def run(name, ratio=None, *, method, **knobs):
    """Solve, and compare with the exact field at the points of Table 2 and over the plane."""
    from references import exact
    from studies.common import field_errors

    scene = sphere_in_cube()
    reference = exact.solve(scene)
    field, row = methods.solved(scene, reference.conductivity / methods.MATRIX, method=method, **knobs)
    looked = (field, _flux_at(field, ratio), reference)
    numbers = {"": PAPERS, "_far": NUMBERS[0]} | ({"_own": knobs["particles"]} if "particles" in knobs else {})
    widths = {ending: field_errors.mean_diameter(number, scene) for ending, number in numbers.items()}
    row |= field_errors.over_plane(*looked, PLANE, GRID, widths) | field_errors.at_points(*looked, POINTS)
    row |= field_errors.at_own_points(field, reference)
    row |= {key: field.stats.get(key) for key in ("elements", "calibration", "mean_radius")}
    if name == "exact":
        return row | field_errors.field_pictures(field, PLANE, PICTURE)
    return row | (field_errors.error_pictures(*looked, PLANE, PICTURE) if _is_pictured(name, **knobs) else {})


def warm_up(name, ratio=None, *, method, **knobs):
    """Make and keep the packing, load and compile."""
    import numpy as np

    from demheat import dem

    if "particles" not in knobs:
        methods.warm_up(method, **knobs)
        return
    from demheat.packing.cache import relaxed

    scene = sphere_in_cube()
    relaxed(knobs["particles"], size=scene.size, periodic=False, seed=knobs["seed"])
    small = dem.solve(scene, **{**knobs, **methods.small(method)})
    middle = np.array([scene.size]) / 2
    small.temperature_at(middle), _flux_at(small, ratio)(middle)


def _flux_at(field, ratio):
    """The flux that is looked at: the halo's where there is one, the field's own elsewhere."""
    if ratio is None:
        return field.flux_at
    from demheat.sampling.halo import halo_flux

    return lambda points: halo_flux(field, ratio=ratio, at=points)


def _is_pictured(name, particles=None, seed=0, size=None, voxels=None, **_):
    """One row of each method per figure: at quick size, and with as many elements as the paper."""
    fine = {"fem": SIZES["fem"][2], "fem-p1": SIZES["fem-p1"][1]}.get(name)
    sizes = (SIZES["fem"][0], fine)
    return (
        name != "dem-plain"
        and seed == 0
        and (
            particles in (NUMBERS[0], PAPERS)
            or (size is not None and size in sizes)
            or voxels in (VOXELS[0], VOXELS[-1])
        )
    )


def claims(df):
    """Laguerre beside the exact field, the paper's network and printed values; FEM and FFT; orders.

    Laguerre is held to 0.5 % of the flux and 0.02 K at Table 2's points with the paper's 1.5e5 elements, where the
    printed flux at C is 3.8 % and more low, and to a tenth of the errors of the paper's network; quick rows to some
    twice as much at the points.
    """
    yield from present([*_exact(df), *_laguerre(df), *_orders(df), *_network(df), *_others(df)])


def _exact(df):
    row = pick(df, name="exact").iloc[0]
    off = max(abs(row[key] - value) * 10**digits for key, (value, digits) in RAYLEIGH.items())
    # Half a unit of the last digit, and the rounding of that half.
    yield "Exact field: off the known values of Table 2's points, in units of their last digits", off, 0.51
    few, many = (-100 * referee.value_error(PAPER[f"q_C_{number}"], row["q_C"]) for number in ("150k", "500k"))
    yield "Printed flux at C, 1.5e5 elements: below the exact one by, %", few, ">= 3.8"
    yield (
        "Printed flux at C: its error with 5e5 elements over that with 1.5e5, so that it is no noise",
        many / few,
        ">= 1",
    )


def _laguerre(df):
    for number, flux, warm, rms, most in ((NUMBERS[0], 1.0, 0.03, 1.5, 15.0), (PAPERS, 0.5, 0.02, 0.6, 3.0)):
        rows = pick(df, name="dem", particles=number)
        text = f"DEM, Laguerre, {number} particles: "
        yield text + "largest error of a flux of Table 2, %", largest(rows, error_columns("q", POINTS)), flux
        yield text + "largest error of a temperature of Table 2, K", largest(rows, error_columns("T", POINTS)), warm
        yield text + "flux away from interface and insulated faces, rms, %", largest(rows, ["flux_rms"]), rms
        yield text + "the same, largest, %", largest(rows, ["flux_max"]), most
        # Found 1.5 and 0.32 %; fits that do not know the interface have 6.2 and 1.8 %.
        yield text + "flux in the band beside them, rms, %", largest(rows, ["flux_rms_band"]), 2.0 * rms
    balance = pick(df, method="dem")["heat_imbalance"].abs().max(skipna=False)
    yield "DEM, all laws: heat in minus heat out over the heat that passes", balance, 1e-6


def _orders(df):
    """Orders in the spacing of L2 errors, over all packings up to the largest.

    The network itself is of second order. So is what is fitted to its temperatures, but the gradient of a quadratic
    through data with scattered errors of second order may lose one: 1.5 says that it does not. Flux is judged over one
    region for all packings, more than a diameter of the coarsest from interface and insulated faces: a region that
    follows the spacing would mix the order with the field's own decay away from the interface.
    """
    rows = pick(df, name="dem")
    for column, what, limit in (
        ("flux_rms_far", "flux away from interface and insulated faces", 1.5),
        ("temperature_rms", "temperature over the whole plane", 1.8),
    ):
        means = rows.groupby("particles")[column].agg(lambda errors: errors.mean(skipna=False))
        found = -3 * order(means.index, means) if len(means) > 2 else None
        yield f"DEM, Laguerre: order of the L2 error in the spacing, {what}", found, f">= {limit}"


def _network(df):
    """The paper's network on the same packings."""
    for number in (NUMBERS[0], PAPERS):
        mine, theirs = (pick(df, name=name, particles=number, seed=0) for name in ("dem", "dem-calibrated"))
        if not len(mine) or not len(theirs):
            continue
        text = f"{number} particles: Laguerre's error over that of the paper's network and its best halo, "
        flux = mine["flux_rms"].max(skipna=False) / theirs["flux_rms"].min(skipna=False)
        yield text + "flux away from interface and insulated faces, rms", flux, 0.1
        warm = mine["own_temperature_rms"].max(skipna=False) / theirs["own_temperature_rms"].min(skipna=False)
        yield text + "temperature of the particles, rms", warm, 0.1


def _others(df):
    for size, rms in ((SIZES["fem"][0], 3.0), (SIZES["fem"][2], 0.5)):
        found = largest(pick(df, name="fem", size=size), ["flux_rms"])
        yield f"FEM, P2, edges of {1e3 * size:g} mm: flux away, rms, %", found, rms
    for voxels, rms in ((VOXELS[0], 3.0), (VOXELS[-1], 0.5)):
        found = largest(pick(df, name="fft", voxels=voxels), ["flux_rms"])
        yield f"FFT, {voxels}^3 laminate voxels: flux away, rms, %", found, rms


def table(df):
    """Table 2: temperature, C, and flux down the load, W/m2, at A (.5, .5, .5) L, B (.08, .5, .5) L, C (.5, .92, .5) L.

    `worst q` is the largest error of the three fluxes. Errors of the flux over the plane, %: away from interface and
    insulated faces, in the band along them, and `own`: more than a mean diameter of the row's own particles away.
    Packings of the same number are averaged. Costs are those of the solve with the packing from the cache; `look` is
    the processor time of 40 000 points. Temperatures of the paper's network between particles are that of the nearest,
    carried on by its raw flux; `T own points` has none of this: rms at the particles, quadrature points or voxels.
    """
    from studies.fig15_16_fields.tables import lines

    return lines(df, PAPER, POINTS)


def plot(df):
    """Fields and their errors side by side on shared scales; errors at the points and against unknowns."""
    from studies.fig15_16_fields.figure import draw

    return draw(df[df["status"] == "ok"], PAPER, POINTS)
