"""The table of fields inside a sphere and around it: methods, and what the paper prints."""

from __future__ import annotations

from demheat import referee
from studies.harness.cells import numbers
from studies.harness.methods import resolution
from studies.harness.pick import pick, with_size

PRINTED = {"DE, 1.5e5": "150k", "DE, 5e5": "500k", "FE, 1e5 tetrahedra": "fe"}
ERRORS = {"flux_rms": "flux rms", "flux_max": "max", "flux_rms_band": "band rms", "flux_max_band": "band max",
          "flux_rms_own": "own rms", "flux_max_own": "own max", "temperature_rms": "T rms", "temperature_max": "T max",
          "own_temperature_rms": "T own points", "relative_temperature": "|dT|/T max", "relative_flux": "|dq|/q max",
          "relative_within": "within 19.6 %"}  # fmt: skip
COSTS = {"unknowns": "unknowns", "cpu_s": "cpu_s", "sample_cpu_s": "look", "peak_mib": "peak_mib"}


def lines(df, paper, points):
    """Table as a data frame.

    Parameters
    ----------
    df : data frame
    paper : dict
        Printed numbers.
    points : dict of str to (3,) tuple
        In edges of the box.
    """
    import pandas as pd

    exact = pick(df, name="exact").iloc[0]
    rows = [_line(label(group.iloc[0]), group, points) for _, group in _grouped(df)]
    rows += [_printed(f"paper's {what}", key, exact, paper, points) for what, key in PRINTED.items()]
    return pd.DataFrame(rows)


def largest(rows, columns):
    """Largest size in some columns of rows; None without rows.

    Parameters
    ----------
    rows : data frame
    columns : list of str

    Returns
    -------
    float or None
    """
    return rows[columns].abs().max(axis=1, skipna=False).max(skipna=False) if len(rows) else None


def error_columns(kind, points):
    """Columns of the errors at the points, of "T" or of "q".

    Parameters
    ----------
    kind : {"T", "q"}
    points : iterable of str

    Returns
    -------
    list of str
    """
    return [f"{kind}_{letter}_error" for letter in points]


def _grouped(df):
    return with_size(df[df["status"] == "ok"]).groupby(["name", "ratio", "h"], dropna=False, sort=False)


def label(row):
    """What a row is, without its resolution."""
    names = {
        "dem": "DEM, Laguerre",
        "dem-plain": "DEM, Laguerre, not conforming",
        "fem": "FEM, P2",
        "fem-p1": "FEM, P1",
    }
    names |= {"fft": "FFT", "exact": "exact"}
    return names.get(row["name"]) or f"DEM as in the paper, halo of {row['ratio']:.3g} radii"


def over_plane(df):
    """Errors over the plane, a line for each method and resolution.

    Parameters
    ----------
    df : data frame
    """
    return _means(df, ERRORS)


def costs(df):
    """Costs, a line for each method and resolution.

    Parameters
    ----------
    df : data frame
    """
    return _means(df, COSTS)


def _means(df, columns):
    import pandas as pd

    found = []
    for _, group in _grouped(df):
        mean = group.mean(numeric_only=True)
        line = {"method": label(group.iloc[0]), "resolution": resolution(group.iloc[0])}
        found.append(line | {title: mean.get(column, float("nan")) for column, title in columns.items()})
    return pd.DataFrame(found)


def in_words(df, paper):
    """What the fluxes of Table 2 say of the paper's halos, as sentences.

    Parameters
    ----------
    df : data frame
    paper : dict
        Printed numbers.
    """
    exact = pick(df, name="exact").iloc[0]
    few, many = (100 * referee.value_error(paper[f"q_C_{number}"], exact["q_C"]) for number in ("150k", "500k"))
    yield (
        f"The printed flux at C is {few:+.1f} % off the exact one with 1.5e5 elements and {many:+.1f} % with 5e5: no "
        "noise."
    )
    network = pick(df, name="dem-calibrated", seed=0)
    at_11 = pick(network, ratio=11.0).groupby("particles")[["q_B", "q_C"]].mean()
    if "halo_q_C" in exact and exact["halo_q_C"] == exact["halo_q_C"]:
        radii = numbers(exact["halo_radius"]).tolist()
        here = radii.index(0.103)
        means = {letter: numbers(exact[f"halo_q_{letter}"])[here] for letter in "BC"}
        yield (
            "The exact flux averaged over halos of .103 L, 11 mean radii of 1.5e5 particles, is "
            f"{means['B']:.0f} at B ({100 * referee.value_error(means['B'], exact['q_B']):+.1f} %, printed "
            f"{paper['q_B_150k']:.0f}) and {means['C']:.0f} at C "
            f"({100 * referee.value_error(means['C'], exact['q_C']):+.1f} %, printed {paper['q_C_150k']:.0f}): "
            "smoothing alone explains B and not C. C is .08 L below the wall, so this halo reaches the particles there, whose "
            "flux by eq. 20 lacks the links to the wall (study fig10_halo)."
        )
    same = network[~network["ratio"].isin((4.0, 11.0))].sort_values("particles")
    if 500_000 in at_11.index and len(same):
        beside = ", ".join(f"{row['q_C']:.0f} with {row['particles']:.0f}" for _, row in same.iterrows())
        yield (
            f"With 5e5 particles a halo of 11 radii, .069 L, ends before the wall: ours gives "
            f"{at_11.loc[500_000, 'q_C']:.0f} there, the paper {paper['q_C_500k']:.0f}. Halos as large in metres as those of 1.5e5 particles reach it: "
            f"{beside} particles; at B {same.iloc[-1]['q_B']:.0f} with {same.iloc[-1]['particles']:.0f}, printed "
            f"{paper['q_B_500k']:.0f}."
        )


def _line(name, group, points):
    mean = group.mean(numeric_only=True)
    line = {"method": name, "resolution": resolution(group.iloc[0])}
    line |= {f"T_{letter}": f"{mean[f'T_{letter}']:.3f}" for letter in points}
    line |= {f"q_{letter}": mean[f"q_{letter}"] for letter in points}
    return line | {"worst q, %": largest(group, error_columns("q", points))}


def _printed(name, key, exact, paper, points):
    line = {"method": name, "resolution": ""}
    line |= {f"T_{letter}": f"{paper[k]:g}" if (k := f"T_{letter}_{key}") in paper else "" for letter in points}
    line |= {f"q_{letter}": paper[f"q_{letter}_{key}"] for letter in points}
    off = [referee.value_error(paper[f"q_{letter}_{key}"], exact[f"q_{letter}"]) for letter in points]
    return line | {"worst q, %": 100 * abs(referee.worst(off)[1])}
