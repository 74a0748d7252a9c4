"""Claims judged on the rows of a study: a sentence, a value and its limit."""

import math
import re
import traceback
from typing import NamedTuple

import numpy as np

from studies.harness.sound import cost_columns, faults
from studies.harness.store import case_key

OPERATORS = {"<=": float.__le__, "<": float.__lt__, ">=": float.__ge__, ">": float.__gt__, "=": float.__eq__}
# Costs that do not count are drawn anew, each by a factor of one to three decades up, then by the same one down: the
# largest and the least of some move by that. Twice, for ranks may stay as they were.
DRAWS, DECADES = 2, (1.0, 3.0)
# A claim that holds with no more room than this factor is a check that later code does as well, and called one, unless
# its sentence says from where the limit is: what a paper prints of its own network, digits that are known, a rate,
# statistics. A study's own words for that are in its ELSEWHERE, with the reason.
NEAR, CHECK = 3.0, "check"
ELSEWHERE = ("The paper's network", "As in the paper", "below the paper's", "printed", "the known ", "order in ")
ELSEWHERE += ("order of ", ": order", "exponent", "standard errors", "standard deviations")
COSTLY = "rests on costs that do not count"
UNFINISHED = "rows are missing"


class Claim(NamedTuple):
    """A sentence with the value that decides it; `limit` is "<= 0.06", ">= 1.7" and the like.

    `why` is empty, or says why it cannot be judged now; then it neither holds nor fails.
    """

    sentence: str
    value: float
    limit: str
    ok: bool
    why: str = ""
    elsewhere: bool = False  # Whether its limit is from elsewhere than its value

    @property
    def failed(self):
        """Whether it was judged and does not hold."""
        return not (self.ok or self.why)

    @property
    def room(self):
        """How far the limit is from the value, as a factor; 1 where it is met, infinite beside a value of nothing."""
        limit, value = float(self.limit.split()[-1]), abs(self.value)
        if limit <= 0 or self.limit.startswith("="):
            return 1.0
        near, far = (limit, value) if self.limit.startswith(">") else (value, limit)
        return far / near if near else math.inf

    @property
    def verdict(self):
        """In a word or two: "ok", "check", "FAIL", "not judged"."""
        return "not judged" if self.why else "FAIL" if not self.ok else CHECK if self._near else "ok"

    @property
    def _near(self):
        """Whether it says no more than that later code does as well; what is to be nothing, or equal, says more."""
        return not self.elsewhere and 1.0 < self.room <= NEAR


def claim(sentence, value, limit):
    """Judge a value by a limit: a number (at most), or text such as ">= 1.7"; not-a-number never holds."""
    limit = f"<= {limit:g}" if isinstance(limit, int | float) else limit
    match = re.fullmatch(r"(<=|>=|<|>|=)\s*(\S+)", limit)
    if match is None:
        raise ValueError(f"limit = {limit!r}: must be a number or such as '<= 0.06', '>= 1.7', '= 0'")
    value = float(value)
    return Claim(sentence, value, limit, OPERATORS[match[1]](value, float(match[2])))


def broken(what, error, *, why=""):
    """The claim that something can be done, which has raised an exception."""
    return Claim(f"{what} ({type(error).__name__}: {error})", math.nan, "= 1", False, why)


def judged(study, df):
    """Claims of a study on its rows; first, that none failed.

    A claim that rests on costs of rows that are dirty or noisy (`sound.faults`) is not judged; nor are, of a run
    that has not ended, those whose rows are not there yet.
    """
    bad = df[df["status"].isin(("failed", "timeout"))]
    found, error = _yielded(study, df)
    unmoved, words = _unmoved(study, df, found), (*ELSEWHERE, *getattr(study, "ELSEWHERE", ()))
    later = UNFINISHED if unfinished(study, df) else ""
    claims = [claim("Rows that failed or ran out of time", float(len(bad)), "= 0")]
    for each in found:
        why = later if math.isnan(each.value) else ""
        each = each._replace(elsewhere=any(word in each.sentence for word in words))
        claims.append(each._replace(why=why) if _key(each) in unmoved else each._replace(ok=False, why=COSTLY))
    return claims if error is None else [*claims, broken("the claims can be judged", error, why=later)]


def unfinished(study, df):
    """Whether rows are neither those of a quick run nor of a full one."""
    every = {case_key(case) for case in study.CASES}
    there = set(df["case"] if "case" in df else ()) & every
    return there not in (every, {case_key(case) for case in study.CASES if study.QUICK(case)})


def with_rows(study, df):
    """Claims of a study one after another, but for those whose rows do not exist: a quick run has no full ones."""
    return (claim(*each) for each in study.claims(df) if each[1] is not None)


def _yielded(study, df, *, quiet=False):
    """Claims up to the first that raises an exception, and that exception."""
    claims = []
    try:
        for each in with_rows(study, df):
            claims.append(each)
    except Exception as error:
        if not quiet:
            traceback.print_exc()
        return claims, error
    return claims, None


def _unmoved(study, df, claims):
    """Those of some claims, as keys, that stay as they are whatever the costs of rows whose costs do not count."""
    unsound = np.array([bool(faults(row)) for row in df.to_dict("records")], dtype=bool)
    columns = [name for name in cost_columns(study, df) if df[name].dtype.kind in "fi"]
    same = set(map(_key, claims))
    if not unsound.any():
        return same
    rng = np.random.default_rng(0)
    for _ in range(DRAWS):
        shape = len(df), len(columns)
        powers = rng.uniform(*DECADES, shape) * rng.choice((-1.0, 1.0), shape) * unsound[:, None]
        for sign in (1.0, -1.0):
            shaken = {name: df[name] * 10.0 ** (sign * powers[:, k]) for k, name in enumerate(columns)}
            same &= set(map(_key, _yielded(study, df.assign(**shaken), quiet=True)[0]))
    return same


def _key(each):
    # Not-a-number is itself here.
    return each.sentence, each.limit, str(each.value)
