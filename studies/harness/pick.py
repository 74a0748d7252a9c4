"""Rows of a data frame by their columns, and errors averaged over packings: what claims and figures are made of."""

from typing import NamedTuple

import numpy as np

from studies.harness import methods

CONFIDENCE = 0.95


class Interval(NamedTuple):
    """Mean of so many realisations, half the width of its confidence interval, and their standard deviation."""

    mean: float
    half: float
    deviation: float
    number: int


def pick(df, **where):
    """Rows whose columns have the given values; None means empty, a missing column is empty everywhere."""
    mask = np.ones(len(df), dtype=bool)
    for column, value in where.items():
        if column not in df:
            mask &= value is None
        else:
            mask &= (df[column].isna() if value is None else df[column] == value).to_numpy(dtype=bool)
    return df[mask]


def with_size(df):
    """The rows with a column `h`, the size of an element over the cube's edge; not-a-number if nothing refines them."""
    return df.assign(h=np.array([methods.size_of(row) for row in df.to_dict("records")], dtype=float))


def finest(rows):
    """Rows of the finest resolution among them, whatever the knob; all of them if there is none."""
    size = with_size(rows)["h"]
    return rows if size.isna().all() else rows[size == size.min()]


def mean_errors(df, by="contrast", **where):
    """Mean error over packings for each value of a column, %, as a Series; not-a-number if a row has none."""
    groups = pick(df, **where).groupby(by)["error_percent"]
    return groups.agg(lambda errors: errors.mean(skipna=False))


def worst(df, **where):
    """Largest |mean error over packings| of any contrast, %; None if there are no such rows."""
    errors = mean_errors(df, **where)
    return abs(errors).max(skipna=False) if len(errors) else None


def extrapolated(df, coarse, fine, **where):
    """Largest |error| of any contrast after extrapolating two particle numbers at second order, %; None without rows.

    The error falls with the square of the particle size, that is with N^(-2/3).
    """
    errors = [mean_errors(df, particles=number, **where) for number in (coarse, fine)]
    if not len(errors[0]) or not len(errors[1]):
        return None
    rest = (errors[0] - errors[1]) / ((fine / coarse) ** (2 / 3) - 1)
    return abs(errors[1] - rest).max(skipna=False)


def student(values):
    """Interval of the mean of two or more values, by Student's distribution."""
    from scipy.stats import t

    deviation = float(np.std(values, ddof=1))
    half = float(t.ppf((1 + CONFIDENCE) / 2, len(values) - 1)) * deviation / np.sqrt(len(values))
    return Interval(float(np.mean(values)), half, deviation, len(values))


def largest(rows, column):
    """Largest size in a column; None without rows, not-a-number if one is missing."""
    return rows[column].abs().max(skipna=False) if len(rows) else None


def order(sizes, errors):
    """Slope of log |error| over log size by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
