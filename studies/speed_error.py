"""Error against CPU time and memory: every method over its resolutions on two sphere scenes, contrast 10.

A centred sphere of radius L/3 ("third") and one that fills half of the cube ("half"), isothermal and insulated faces.
The DEM is timed twice: with its packing made on the spot, and with the packing from the cache. The cost of a Laguerre
tessellation is set beside Voro++'s, that of the steady solver beside plain pyamg's on the same matrix, and that of the
scalar FFT scheme beside Eyre-Milton's, each pair on the same data.
"""

import tempfile

from demheat import referee
from demheat.gallery import EDGE, sphere_in_cube
from studies.common import peers
from studies.harness import methods
from studies.harness.figures import LOOK, look
from studies.harness.methods import resolution
from studies.harness.pick import pick, present, with_size

FRACTIONS = {"third": methods.THIRD, "half": methods.HALF}
CONTRAST = 10.0
# What stands beside the methods that every study compares.
BESIDE = ("dem-calibrated", "fem-straight", "fem-p1", "fft-plain")
PARTICLES = (1_000, 3_000, 10_000, 30_000, 100_000, 400_000)
VOXELS = (32, 64, 128, 256)
# By knob, or by name where a method needs others; sizes in edges of the cube.
RESOLUTIONS = {
    "particles": PARTICLES,
    "dem-calibrated": PARTICLES[:-1],
    "size": (0.2, 0.14, 0.1, 0.07, 0.05, 0.035),
    "fem-p1": (0.1, 0.07, 0.05, 0.035, 0.025, 0.018),
    "voxels": VOXELS,
}
TARGETS = (1.0, 0.1, 0.01)  # per cent
# To compare the FFT schemes: tolerances that bring each within 1e-6 of its own limit, which the tight one shows.
TO_LIMIT, TIGHT = {"fft": 1e-3, "fft-em": 3e-6}, 1e-9
TIMEOUT = 3600.0


def _cases():
    for scene in FRACTIONS:
        for method in methods.compared(*BESIDE):
            for value in methods.spent(method, RESOLUTIONS):
                seeds = (0, 1, 2) if method.name == "dem" and value < 100_000 else (0,)
                knobs = (methods.at(method, value, seed) for seed in seeds)
                yield from (methods.case(method.name, scene=scene, **each) for each in knobs)
    for voxels in VOXELS[1::2]:
        for name, loose in TO_LIMIT.items():
            yield from (methods.case(name, scene="third", voxels=voxels, tolerance=each) for each in (loose, TIGHT))
    for name, numbers in (("tessellation", (10_000, 100_000)), ("steady", (20_000, 1_000_000))):
        yield from ({"name": name, "particles": number, "seed": 0, "method": "dem"} for number in numbers)


CASES = list(_cases())
PAPER = {}


def QUICK(case):
    """Coarse rows of the first scene."""
    small = case.get("particles", 0) <= 20_000 and case.get("size", EDGE) > 0.06 * EDGE and case.get("voxels", 0) <= 64
    return small and case.get("scene") != "half" and case.get("seed", 0) == 0


def run(name, particles=None, seed=None, scene=None, **solver):
    """Solve one case, the DEM from an empty packing cache and then again; or time our kernels beside their peers."""
    if name == "tessellation":
        return peers.tessellation(particles, seed)
    if name == "steady":
        return peers.steady(particles, seed, sphere_in_cube(CONTRAST))
    cube, ratio = sphere_in_cube(CONTRAST, fraction=FRACTIONS[scene]), methods.exact_ratio(FRACTIONS[scene], CONTRAST)
    if particles is None:
        return methods.solve_row(cube, ratio, **solver)
    with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
        cold, warm = (methods.solve_row(cube, ratio, particles=particles, seed=seed, **solver) for _ in range(2))
    return cold | {f"cached_{key}": warm[key] for key in ("wall_s", "cpu_s", "peak_mib")}


def warm_up(name, particles=None, seed=None, scene=None, **solver):
    """Load the solver; the peers load their own."""
    if name not in ("tessellation", "steady"):
        methods.warm_up(**solver)


def claims(df):
    """Kernels beside their peers on the same data; how many methods reach 0.1 %.

    A kernel must not be slower than its peer. Costs of a quick run are too small to judge.
    """
    yield from present([*_kernel_claims(df), *_scheme_claims(df)])
    for scene in sorted(df["scene"].dropna().unique()):
        found = cheapest(df[df["scene"] == scene])
        yield f"Methods that reach 0.1 % on the scene {scene!r}", float((found["target"] == 0.1).sum()), ">= 3"


def _kernel_claims(df):
    row = pick(df, name="tessellation", particles=100_000)
    if len(row):
        ours, theirs = row["us_per_particle"].iloc[0], row["peer_us_per_particle"].iloc[0]
        yield "Laguerre tessellation of 100000 particles: CPU microseconds per particle", ours, 40.0
        if theirs == theirs:
            yield "Laguerre tessellation of 100000 particles: CPU time over that of Voro++", ours / theirs, 1.0
    row = pick(df, name="steady", particles=1_000_000)
    if len(row):
        best = row[["ruge_stuben_cpu_s", "aggregation_cpu_s"]].min(axis=1).iloc[0]
        yield (
            "Steady solve of 1e6 particles: CPU time over that of the best plain pyamg",
            row["cpu_s"].iloc[0] / best,
            1.0,
        )


def _scheme_claims(df):
    for voxels in VOXELS[1::2]:
        loose, tight = (
            [pick(df, name=name, scene="third", voxels=voxels, tolerance=each) for name, each in tolerances.items()]
            for tolerances in (TO_LIMIT, dict.fromkeys(TO_LIMIT, TIGHT))
        )
        if not all(len(rows) == 1 for rows in (*loose, *tight)):
            continue
        pairs = ((a["k_ratio"].iloc[0], b["k_ratio"].iloc[0]) for a, b in zip(loose, tight, strict=True))
        off = max(abs(referee.value_error(*pair)) for pair in pairs)
        yield f"FFT {voxels}^3: difference of either scheme from its own limit", off, 1e-6
        if voxels == VOXELS[-1]:
            scalar, eyre_milton = (rows["cpu_s"].iloc[0] for rows in loose)
            yield (
                f"FFT {voxels}^3: CPU time of Eyre-Milton over that of the scalar scheme",
                eyre_milton / scalar,
                ">= 3",
            )


def points(df):
    """One point per method, scene and resolution: largest |error| of its packings, %, mean costs."""
    import pandas as pd

    rows = []
    solves = df[df["scene"].notna() & df["tolerance"].isna() & (df["status"] == "ok")]
    for (scene, name, _), group in with_size(solves).groupby(["scene", "name", "h"], dropna=False, sort=False):
        row = {"scene": scene, "name": name, "error": group["error_percent"].abs().max()}
        row |= {key: group[key].mean() for key in ("unknowns", "cpu_s", "peak_mib", "cached_cpu_s")}
        rows.append(row | {"resolution": resolution(group.iloc[0])})
    return pd.DataFrame(rows)


def cheapest(df):
    """For each target and method the cheapest resolution from which on every finer one stays within the target."""
    import pandas as pd

    found = []
    for (scene, _), group in points(df).groupby(["scene", "name"], sort=False):
        group = group.sort_values("unknowns")
        # An error may cross zero by luck: only a resolution after which all stay good counts.
        lasting = group["error"][::-1].cummax()[::-1]
        for target in TARGETS:
            good = group[lasting <= target]
            if len(good):
                found.append({"scene": scene, "target": target, **good.loc[good["cpu_s"].idxmin()]})
    columns = ["target", "scene", "name", "resolution", "error", "unknowns", "cpu_s", "cached_cpu_s", "peak_mib"]
    return pd.DataFrame(found, columns=columns).sort_values(
        ["scene", "target", "cpu_s"], ascending=[False, False, True]
    )


def table(df):
    """The cheapest resolution of each method for each target error, cheapest method first."""
    found = cheapest(df)
    return found.assign(name=found["name"].map(lambda name: LOOK[name][0]))


def plot(df):
    """Error against CPU time and against memory on both scenes."""
    from matplotlib import pyplot

    every = points(df)
    scenes = [scene for scene in FRACTIONS if scene in set(every["scene"])]
    figure, panels = pyplot.subplots(len(scenes), 2, figsize=(11, 1 + 4 * len(scenes)), squeeze=False, sharey="row")
    for row, scene in zip(panels, scenes, strict=True):
        for name, group in every[every["scene"] == scene].groupby("name", sort=False):
            group = group.sort_values("unknowns")
            row[0].plot(group["cpu_s"], group["error"], **look(name))
            row[1].plot(group["peak_mib"], group["error"], **look(name))
            if name == "dem":
                cached = look(name, label="the same, packing from the cache", markerfacecolor="white", linestyle=":")
                row[0].plot(group["cached_cpu_s"], group["error"], **cached)
        row[0].set(xscale="log", yscale="log", xlabel="CPU time, s", ylabel="|error of the conductivity|, %")
        row[1].set(xscale="log", xlabel="peak memory of the solve, MiB")
        row[0].set_title(f"sphere of volume fraction {FRACTIONS[scene]:.3f}, contrast {CONTRAST:g}")
    winner = cheapest(df)
    best = winner[(winner["target"] == 0.1) & (winner["scene"] == "third")].iloc[0]
    figure.suptitle(f"0.1 % costs least by {LOOK[best['name']][0]}: {best['cpu_s']:.2g} CPU-s")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
