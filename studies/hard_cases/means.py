"""Verdicts of rows as a data frame, and shares of them."""

import json

import pandas as pd

from studies.hard_cases.verdicts import Verdict
from studies.hard_cases.ways import AUTO
from studies.harness import methods

JUDGED = ("verified", "warned", "wrong")


def verdicts(df):
    """One line for each case: family, seed, and what `Verdict` has."""
    found = [
        {"family": row["family"], "seed": row["seed"], **Verdict(*each)._asdict()}
        for row in df[df["status"] == "ok"].to_dict("records")
        for each in json.loads(row["verdicts"])
    ]
    return pd.DataFrame(found, columns=["family", "seed", *Verdict._fields])


def title(name: str) -> str:
    """What a method is called in tables."""
    base = name.split(",")[0]
    if base == AUTO:
        return "FFT, scalar, by itself"
    method = methods.all_methods().get(base)
    return method.title if method else base


def is_main(name: str) -> bool:
    """Whether a method is none that is declared to stand beside others."""
    method = methods.all_methods().get(name)
    return method is None or method.role != "beside"


def share(each, main: float, beside: float):
    """Title, verified share of the answers that are judged, and the least that is asked, of each method."""
    answers = each[each["outcome"].isin(JUDGED)]
    base = answers["method"].str.split(",").str[0]
    for name in dict.fromkeys(base):
        right = (answers[base == name]["outcome"] == "verified").mean()
        yield title(name), float(right), main if is_main(name) else beside
