"""Errors of the study of tuning, in per cent, read off its rows; what is made of them."""

import numpy as np
import pandas as pd

from demheat.referee import value_error
from studies.harness.cells import numbers
from studies.harness.pick import order, pick
from studies.tuning.scenes import FAMILIES

PERCENT = 100.0


def known(df, group):
    """What witnesses say of the scenes of one group: conductivity and doubt, by family and number of the scene."""
    lines = []
    for _, row in pick(df, part="reference", group=group).iterrows():
        pairs = zip(numbers(row["k"]), numbers(row["doubt"]), strict=True)
        lines += [(row["family"], number, k, PERCENT * doubt) for number, (k, doubt) in enumerate(pairs)]
    return pd.DataFrame(lines, columns=["family", "scene", "known", "doubt_percent"])


def errors(df, group, part="varied"):
    """Errors of every solve whose scene has a witness, one line each."""
    right, lines = known(df, group), []
    for _, row in pick(df, part=part, group=group).iterrows():
        same = {name: row[name] for name in ("constant", "factor", "particles", "unknowns")}
        for family in FAMILIES:
            if isinstance(row.get(family), str | float) and row[family] == row[family]:
                lines += [same | {"family": family, "scene": n, "k": k} for n, k in enumerate(numbers(row[family]))]
    found = pd.DataFrame(lines, columns=["constant", "factor", "particles", "unknowns", "family", "scene", "k"])
    found["constant"] = named(found["constant"])
    found = found.merge(right, on=["family", "scene"])
    return found.assign(error=PERCENT * value_error(found["k"], found["known"]))


def named(constants):
    """Names of constants, empty where a row has none."""
    return [name if isinstance(name, str) else "" for name in constants]


def summed(found, by=("constant", "factor", "particles")):
    """Median and 90th percentile of |error|, mean error and its standard error, %; mean unknowns; by group."""
    size = found.assign(size=found["error"].abs())
    groups = size.groupby(list(by), sort=False)
    return groups.agg(
        median=("size", "median"),
        high=("size", lambda sizes: sizes.quantile(0.9)),
        mean=("error", "mean"),
        sem=("error", "sem"),
        unknowns=("unknowns", "mean"),
        scenes=("error", "size"),
    ).reset_index()


def against_best(sums):
    """For each constant and number of particles: the shipped median error over the least of all its values."""
    lines = []
    for particles, rows in sums.groupby("particles"):
        shipped = pick(rows, constant="")
        if shipped.empty or len(rows) < 2:
            continue
        own = shipped["median"].iloc[0]
        for constant, group in rows[rows["constant"] != ""].groupby("constant", sort=False):
            best = group.loc[group["median"].idxmin()]
            factor = best["factor"] if best["median"] < own else 1.0
            lines.append((constant, particles, own / min(own, best["median"]), factor))
    return pd.DataFrame(lines, columns=["constant", "particles", "ratio", "best"])


def wins(found, gain):
    """Values of constants that lower the median error of every family by so much, as "OFFSET x 0.7"."""
    sums = summed(found, by=("constant", "factor", "family"))
    shipped = pick(sums, constant="").set_index("family")["median"]
    better = []
    for (constant, factor), group in sums[sums["constant"] != ""].groupby(["constant", "factor"], sort=False):
        median = group.set_index("family")["median"]
        if (median < (1 - gain) * shipped.reindex(median.index)).all():
            better.append(f"{constant} x {factor:g}")
    return better


def parts(df, **where):
    """Means over packings of the parts of the error, %, and the scatter of one packing, by number of particles."""
    lines = []
    for _, row in pick(df, part="order", **where).sort_values("particles").iterrows():
        line = {"particles": row["particles"]}
        for name in ("error", "quadrature", "misfit", "misfit_beside", "volume"):
            values = numbers(row[name])
            line |= {name: values.mean(), f"{name}_sem": values.std(ddof=1) / len(values) ** 0.5}
            line |= {f"{name}_scatter": values.std(ddof=1)}
        lines.append(line | {"packings": len(values)})
    return pd.DataFrame(lines)


def fitted(table, name, *, draws=400):
    """Order of a column in the particle size and its standard error, from the errors of its means."""
    sizes = table["particles"].to_numpy(float) ** (-1 / 3)
    values, rng = table[name].to_numpy(float), np.random.default_rng(0)
    if name.endswith("_scatter"):
        # Of a standard deviation from so many packings.
        doubt = values / np.sqrt(2 * (table["packings"].to_numpy(float) - 1))
    else:
        doubt = table[f"{name}_sem"].to_numpy(float)
    drawn = values + doubt * rng.normal(size=(draws, len(values)))
    drawn = drawn[(np.sign(drawn) == np.sign(values)).all(axis=1)]
    orders = [order(sizes, each) for each in drawn]
    return order(sizes, values), float(np.std(orders)) if len(orders) > draws / 2 else float("nan")


def two_powers(table, name="error"):
    """A column as a h^2 + b h^3, h = particles^(-1/3), by least squares weighted by the errors of its means."""
    size = table["particles"].to_numpy(float) ** (-1 / 3)
    weight = 1 / table[f"{name}_sem"].to_numpy(float)
    matrix, right = np.column_stack([size**2, size**3]) * weight[:, None], table[name].to_numpy(float) * weight
    values = np.linalg.lstsq(matrix, right, rcond=None)[0]
    poor = max(1.0, np.sum((matrix @ values - right) ** 2) / (len(size) - 2))
    return values, np.sqrt(poor * np.diag(np.linalg.inv(matrix.T @ matrix)))
