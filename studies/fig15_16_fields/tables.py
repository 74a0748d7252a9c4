"""The table of fields inside a sphere and around it: methods, and what the paper prints."""

from __future__ import annotations

from demheat import referee
from studies.harness.methods import resolution
from studies.harness.pick import pick, with_size

PRINTED = {"DE, 1.5e5": "150k", "DE, 5e5": "500k", "FE, 1e5 tetrahedra": "fe"}
SHOWN = {"flux_rms": "flux rms", "flux_max": "max", "flux_rms_band": "band rms", "flux_max_band": "band max",
         "flux_rms_own": "own rms", "flux_max_own": "own max", "temperature_rms": "T rms", "temperature_max": "T max",
         "own_temperature_rms": "T own points",
         "unknowns": "unknowns", "cpu_s": "cpu_s", "sample_cpu_s": "look", "peak_mib": "peak_mib"}  # fmt: skip


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
    return names.get(row["name"]) or f"DEM as in the paper, halo of {row['ratio']:.0f} radii"


def _line(name, group, points):
    mean = group.mean(numeric_only=True)
    line = {"method": name, "resolution": resolution(group.iloc[0])}
    line |= {f"T_{letter}": f"{mean[f'T_{letter}']:.3f}" for letter in points}
    line |= {f"q_{letter}": mean[f"q_{letter}"] for letter in points}
    line["worst q, %"] = largest(group, error_columns("q", points))
    return line | {title: mean.get(column, float("nan")) for column, title in SHOWN.items()}


def _printed(name, key, exact, paper, points):
    line = {"method": name, "resolution": ""}
    line |= {f"T_{letter}": f"{paper[k]:g}" if (k := f"T_{letter}_{key}") in paper else "" for letter in points}
    line |= {f"q_{letter}": paper[f"q_{letter}_{key}"] for letter in points}
    off = [referee.value_error(paper[f"q_{letter}_{key}"], exact[f"q_{letter}"]) for letter in points]
    return line | {"worst q, %": 100 * abs(referee.worst(off)[1])} | dict.fromkeys(SHOWN.values(), float("nan"))
