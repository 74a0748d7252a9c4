"""Stored rows of studies with their results dealt out anew, or spoiled, and what the claims then say."""

import re
import warnings
from collections import Counter

import numpy as np
import pandas as pd

from studies.harness import table
from studies.harness.claims import with_rows

# What a row has besides what was asked for and what it found.
ORIGIN = ("case", "code", "commit", "when", "machine", "host", "threads", "versions", "load", "beside", "triad_gbs")
WORDS = ("note", "peak_by", "version")
NUMBERS = re.compile(r"\[.*?\]|[-+]?\d[\d.]*(e[-+]?\d+)?")
# What is done to every number of a result; "denied" and "opened" are done to verdicts.
CHANGES = {
    "tenfold": lambda value, rng: 10 * value,
    "a tenth": lambda value, rng: value / 10,
    "turned": lambda value, rng: -value,
    "moved": lambda value, rng: value + rng.exponential(),
    "unlike": lambda value, rng: value * 10 ** rng.normal(),
}
SPOILS = (*CHANGES, "denied", "opened")


def results(study, df):
    """Columns that the rows themselves brought: neither what was asked for nor where they come from."""
    asked = {name for case in study.CASES for name in case}
    return [name for name in df if name not in asked and name not in (*ORIGIN, *WORDS)]


def dealt(study, df, seed):
    """The rows with each result given to another row that has one, each column in an order of its own."""
    rng, columns = np.random.default_rng(seed), {}
    for name in results(study, df):
        column = df[name].copy()
        there = column.notna().to_numpy()
        column[there] = rng.permutation(column[there].to_numpy(copy=True))
        columns[name] = column
    return df.assign(**columns)


def spoiled(study, df, how, names=None, seed=2):
    """The rows with every number changed, or every verdict; of all results, or of some."""
    rng = np.random.default_rng(seed)
    names = [name for name in names or results(study, df) if name != "status"]
    return df.assign(**{name: df[name].map(lambda value: _changed(value, how, rng)) for name in names})


def gone(study, df):
    """The rows as if all had failed, without results."""
    return df.assign(**{name: np.nan for name in results(study, df)}, note="").assign(status="failed")


def _changed(value, how, rng):
    if isinstance(value, bool | np.bool_):
        return not value if how == "denied" else value
    if isinstance(value, str):
        if how in ("denied", "opened"):
            return value.replace("verified", "wrong" if how == "denied" else "open")
        try:
            # Some cells hold several numbers.
            return " ".join(f"{_changed(float(part), how, rng):.8g}" for part in value.split())
        except ValueError:
            return value
    return CHANGES[how](value, rng) if how in CHANGES else value


def judged(study, df):
    """Claims by their sentences without numbers, and their place among those alike; what cannot be judged ends them."""
    found, seen = {}, Counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            for claim in with_rows(study, df):
                key = NUMBERS.sub("#", claim.sentence)
                seen[key] += 1
                found[key, seen[key]] = claim
        except Exception:
            # As in the harness: those that follow are not there, and the page has one more, which failed.
            pass
    return found


def as_bad(claim, others):
    """Whether the value is no better than most of some others: then no limit that it holds could tell them apart."""
    sign = -1 if claim.limit.startswith(">") else 1
    values = np.array([other.value for other in others])
    return bool(np.mean(sign * values <= sign * claim.value * (1 + sign * np.sign(claim.value) * 1e-12)) >= 0.9)


def frame(study, path):
    """Stored rows of a study."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pd.errors.DtypeWarning)
        return table.read_frame(study, path)
