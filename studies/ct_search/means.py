"""What the rows of the search say of more particles, how far that is off what is printed, and the best set."""

import numpy as np

from demheat import referee
from studies.harness.pick import pick
from studies.harness.printed import printed

PAPER = printed("ct_search")
NUMBER = 3_000  # particles of a row's packings
SPHERE = 150_000  # elements of the printed error with one sphere
# Exponents of the walls' share in the number of particles, and of the sphere's error in the spacing; half widths.
WALLS, WALLS_HALF = 1 / 3, 0.02
ORDER, ORDER_HALF = 1.25, 0.25
WEIGHTINGS = {"number": "cov", "volume": "cov_volume"}
# What is printed -> tolerance, relative; those of LEAST are one-sided, limits.
TOLERANCES = {"ct_1e5": 0.02, "ct_1e6": 0.02, "cov_0": 0.25, "cov_4": 0.25, "cov_11": 0.25}
LIMITS = {"sphere": PAPER["sphere"], "under_2": 0.2}
JUDGED = (*TOLERANCES, *LIMITS)
NAMES = {
    "ct_1e5": "C_t at 1e5",
    "ct_1e6": "C_t at 1e6",
    "cov_0": "own flux",
    "cov_4": "halo of 4",
    "cov_11": "halo of 11",
    "sphere": "one sphere",
    "under_2": "links",
}


def between_walls(cell, block, number, exponent=WALLS):
    """C_t between walls for a number of particles, from the periodic cell's and that of NUMBER between walls."""
    return cell - (cell - block) * (NUMBER / number) ** exponent


def predicted(df):
    """The rows that are ok, with `ct_1e5`, `ct_1e6`, `sphere` and its range, `under_2` in per cent; and half widths."""
    df = pick(df, status="ok").copy()
    for name, number in (("ct_1e5", 1e5), ("ct_1e6", 1e6)):
        df[name] = between_walls(df["ct_cell"], df["ct_block"], number)
        ends = (between_walls(df["ct_cell"], df["ct_block"], number, WALLS + sign * WALLS_HALF) for sign in (-1, 1))
        low, high = ends
        df[f"{name}_half"] = (high - low).abs() / 2
    here = df[[name for name in df if name.startswith("error_")]].abs().max(axis=1, skipna=False)
    finer = (NUMBER / SPHERE) ** (1 / 3)
    for name, order in (("sphere", ORDER), ("sphere_low", ORDER + ORDER_HALF), ("sphere_high", ORDER - ORDER_HALF)):
        df[name] = here * finer**order
    return df.assign(under_2=100 * df["under_2"])


def ranked(df):
    """A line for each set and weighting of the scatter, by the largest of its misfits, the best first."""
    import pandas as pd

    rows, lines = predicted(df), []
    for weighting, column in WEIGHTINGS.items():
        found = rows.assign(weighting=weighting, **{f"cov_{r}": rows[f"{column}_{r}"] for r in (0, 4, 11)})
        for name, tolerance in TOLERANCES.items():
            found[f"misfit_{name}"] = referee.value_error(found[name], PAPER[name]) / tolerance
        for name, limit in LIMITS.items():
            found[f"misfit_{name}"] = found[name] / limit
        sizes = found[[f"misfit_{name}" for name in JUDGED]].abs()
        lines.append(found.assign(worst=sizes.max(axis=1, skipna=False), by=sizes.idxmax(axis=1).str[len("misfit_") :]))
    return pd.concat(lines).sort_values("worst", kind="stable").reset_index(drop=True)


def shown(df):
    """Table of the search: each set once, with the weighting that suits it better."""
    found = ranked(df).drop_duplicates(["spread", "links", "mean"], ignore_index=True)
    found = found.assign(
        sphere_range=[f"{a:.2f} to {b:.2f}" for a, b in zip(found["sphere_low"], found["sphere_high"], strict=True)],
    )
    for name in ("ct_cell", "ct_block", "ct_1e5", "ct_1e6"):
        found[name] = found[name].map("{:.3f}".format)
    names = ["spread", "links", "mean", "weighting", "worst", "by", "ct_cell", "ct_1e5", "ct_1e6", "cov_0", "cov_4",
             "cov_11", "sphere", "sphere_range", "under_2", "gap"]  # fmt: skip
    found = found[names].assign(by=found["by"].map(NAMES))
    paper = {name: PAPER[name] for name in ("cov_0", "cov_4", "cov_11", "sphere")}
    paper |= {"spread": PAPER["spread"], "links": PAPER["links"], "mean": "printed"}
    paper |= {name: f"{PAPER[name]:.3f}" for name in ("ct_1e5", "ct_1e6")}
    text = dict.fromkeys(("weighting", "by", "ct_cell", "sphere_range"), "")
    found.loc[len(found)] = {name: np.nan for name in names} | text | paper
    return found.rename(columns={"worst": "largest misfit", "by": "of"})


def in_words(df):
    """The best set and those that the paper's words name, as sentences."""
    found = ranked(df)
    best = found.iloc[0]
    fits = "This set gives all that is printed" if best["worst"] <= 1 else "No set gives all that is printed; the best"
    yield f"{fits}: {_said(best)}."
    yield from _of_the_rest(found)
    rise = 100 * referee.value_error(found["ct_1e6"], found["ct_1e5"])
    asked = 100 * referee.value_error(PAPER["ct_1e6"], PAPER["ct_1e5"])
    yield (
        f"From 1e5 to 1e6 elements C_t rises by {asked:.1f} % as printed, by {rise.min():.1f} to {rise.max():.1f} % "
        "with the sets."
    )
    for spread, what in ((PAPER["spread"], "As printed"), (PAPER["spread"] / 2, "With half the printed spread")):
        rows = pick(found, spread=spread, links=PAPER["links"], mean="arithmetic")
        if len(rows):
            yield f"{what}: {_said(rows.iloc[0])}."


def _of_the_rest(found):
    """What no set meets, and the best set for all that some do."""
    sizes = found[[f"misfit_{name}" for name in JUDGED]].abs()
    never = [name for name in JUDGED if sizes[f"misfit_{name}"].min() > 1]
    rest = [f"misfit_{name}" for name in JUDGED if name not in never]
    if not never or not rest:
        return
    ranges = " and ".join(
        f"{NAMES[name]} ({found[name].min():.2f} to {found[name].max():.2f} %, printed {PAPER[name]:g})"
        for name in never
    )
    place = sizes[rest].max(axis=1).idxmin()
    best = found.loc[place]
    yield (
        f"No set at all meets {ranges}: neither spread nor links nor R_m is what those depend on. Of all else the best "
        f"set is spread {best['spread']:g}, {best['links']:g} links, {best['mean']} mean radius, largest misfit "
        f"{sizes.loc[place, rest].max():.1f}."
    )


def _said(row):
    off = ", ".join(f"{NAMES[name]} {row[f'misfit_{name}']:+.1f}" for name in JUDGED)
    return (
        f"spread {row['spread']:g}, {row['links']:g} links, {row['mean']} mean radius, scatter by {row['weighting']}: "
        f"C_t {row['ct_1e5']:.3f} +- {row['ct_1e5_half']:.3f} at 1e5 and {row['ct_1e6']:.3f} at 1e6, scatter "
        f"{row['cov_0']:.0f}, {row['cov_4']:.1f} and {row['cov_11']:.1f} %, one sphere {row['sphere']:.2f} % "
        f"({row['sphere_low']:.2f} to {row['sphere_high']:.2f}), {row['under_2']:.2f} % of the particles with fewer "
        f"than 2 links; misfits in tolerances: {off}"
    )
