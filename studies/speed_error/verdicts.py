"""Claims on the rows of speed against error."""

from demheat import referee
from studies.harness.pick import pick
from studies.speed_error import means
from studies.speed_error.cases import COMPARED, TIGHT, TO_LIMIT

# Solves that were run twice, at least, of which nine in ten say something.
OFTEN = 20


def claims(df):
    """Kernels beside their peers on the same data; how costs scatter.

    A kernel must not be slower than its peer. Costs of a quick run are too small to judge. When values were known the
    tessellation came down from 40, 20 and 15 microseconds and once Voro++, schemes from 1e-6; what is a tie was set by
    how costs scatter.
    """
    yield from [*_kernels(df), *_schemes(df)]
    again = means.run_twice(df)
    if len(again) >= OFTEN:
        yield "DEM, the same solve twice: factor within which nine costs in ten are", again.quantile(0.9), means.TIE


def _kernels(df):
    row = pick(df, name="tessellation", particles=100_000)
    if len(row):
        ours, theirs = row["us_per_particle"].iloc[0], row["peer_us_per_particle"].iloc[0]
        yield "Laguerre tessellation of 100000 particles: CPU microseconds per particle", ours, 10.0
        if theirs == theirs:
            yield "Laguerre tessellation of 100000 particles: CPU time over that of Voro++", ours / theirs, 0.4
    row = pick(df, name="steady", particles=1_000_000)
    if len(row):
        best = row[["ruge_stuben_cpu_s", "aggregation_cpu_s"]].min(axis=1).iloc[0]
        text = "Steady solve of 1e6 particles: CPU time over that of the best plain pyamg"
        yield text, row["cpu_s"].iloc[0] / best, 1.0


def _schemes(df):
    for voxels in COMPARED:
        loose, tight = (
            [pick(df, name=name, scene="third", voxels=voxels, tolerance=each) for name, each in tolerances.items()]
            for tolerances in (TO_LIMIT, dict.fromkeys(TO_LIMIT, TIGHT))
        )
        if not all(len(rows) == 1 for rows in (*loose, *tight)):
            continue
        pairs = ((a["k_ratio"].iloc[0], b["k_ratio"].iloc[0]) for a, b in zip(loose, tight, strict=True))
        off = max(abs(referee.value_error(*pair)) for pair in pairs)
        yield f"FFT {voxels}^3: difference of either scheme from its own limit", off, 3e-7
        if voxels == COMPARED[-1]:
            scalar, eyre_milton = (rows["cpu_s"].iloc[0] for rows in loose)
            text = f"FFT {voxels}^3: CPU time of Eyre-Milton over that of the scalar scheme"
            yield text, eyre_milton / scalar, ">= 3"
