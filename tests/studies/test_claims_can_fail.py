"""No claim holds whatever the rows are: stored rows are dealt out anew, spoiled and taken away, and limits are near.

Nothing is computed anew. A claim is as good as the worst rows that it accepts:

- it has rows: its value is a number, and it does not hold where all rows are gone or have failed;
- on results that are dealt out anew it fails at least once in six times. Where they cannot tell (the value is the
  worst that there is, so that any order of the rows is as good) or the limit is within three times the value, it must
  fail when the results are spoiled: ten times as large, a tenth, of the other sign, moved, scattered, denied;
- its limit is within three times the value, or the study's `REASONS` says why not;
- where it fails the study's `FAILS` says why.
"""

from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import NamedTuple

import dealt
import numpy as np
import pandas as pd
import pytest
from blocks import blocks

from studies.__main__ import study_names
from studies.harness import explained, runner
from studies.harness.claims import NEAR

RESULTS = Path(__file__).parents[2] / "results"
DEALS, KEPT = 6, 0.9
STORED = [name for name in study_names() if (RESULTS / f"{name}.csv").exists()]
# Judged a dozen times or more, these take over a CPU-second each: `make test-slow`.
SLOW = (
    *("contrasts", "estimates", "fig12_15_sheet", "fig14_single_inclusion", "fig15_16_fields", "fig17_etc"),
    *(
        "fig18_fields",
        "formless",
        "frontier",
        "intervals",
        "packings",
        "peers",
        "resistance",
        "scaling",
        "shapes",
        "speed_error",
        "sphere_benchmark",
    ),
    *("tuning", "zeta2"),
)
# Claims that no order of the rows and no change of the results make fail, and why.
EXCEPTIONS = {
    "Cells of 6 D against cells of 9 D": "two means that should not differ: any others dealt to both do not either",
    "Steady solve, 1000000 particles": "one row, whose two costs are spoiled alike; speed_error asks the same of more",
    "Steady solve of 1e6 particles": "one row, the dearest that there is: whatever cost is dealt to it is less",
    "worst error over that of the paper's network's best": "a tenth of errors of per cents: dealt rows are as good",
    "sphere 10: the worst of our methods": "the best of each method, which any deal of errors on one sphere leaves",
    "100000 particles: values that lower": "a win in every family is rare by chance; with fewer particles it fails",
}


class Judged(NamedTuple):
    """A study with its rows, its claims on them, and on rows dealt out anew."""

    study: object
    df: pd.DataFrame
    own: dict
    deals: list


def judged(study, df):
    deals = [dealt.judged(study, dealt.dealt(study, df, seed)) for seed in range(DEALS)]
    return Judged(study, df, dealt.judged(study, df), deals)


@cache
def stored(name):
    study = runner.load(name)
    return judged(study, dealt.frame(runner.load(name), RESULTS / f"{name}.csv"))


def holding_anyhow(found):
    """Sentences of claims that hold, and hold on rows dealt out anew and on spoiled ones, or are too loose to tell."""
    doubtful, loose = {}, []
    for key, claim in found.own.items():
        others = [deal[key] for deal in found.deals if key in deal]
        excepted = any(words in claim.sentence for words in EXCEPTIONS)
        if not claim.ok or excepted or np.mean([other.ok for other in others] or [0]) < KEPT:
            continue
        if not dealt.as_bad(claim, others) and claim.room > NEAR:
            loose.append(claim.sentence)
        doubtful[key] = claim
    for rows in _spoiled(found.study, found.df):
        if not doubtful:
            break
        after = dealt.judged(found.study, rows)
        doubtful = {key: claim for key, claim in doubtful.items() if key not in after or after[key].ok}
    return sorted({*loose, *(claim.sentence for claim in doubtful.values())})


def _spoiled(study, df):
    """All results at once; halves of them, for ratios of two; each alone, as others may leave nothing to be judged."""
    yield from (dealt.spoiled(study, df, how) for how in dealt.SPOILS)
    # Of two numbers one grows as often as the other: a ratio of them may need more than one try.
    yield from (dealt.spoiled(study, df, "unlike", seed=seed) for seed in range(3, 11))
    names = [name for name in dealt.results(study, df) if df[name].notna().any()]
    for bit in range(len(names).bit_length()):
        for side in (0, 1):
            yield dealt.spoiled(study, df, "tenfold", [n for k, n in enumerate(names) if k >> bit & 1 == side])
    yield from (dealt.spoiled(study, df, "tenfold", [name]) for name in names)


def without_rows(found):
    """Sentences of claims whose value is no number, or that hold where there are no rows."""
    nothing = set()
    for rows in (found.df.iloc[:0], dealt.gone(found.study, found.df)):
        nothing |= {key for key, claim in dealt.judged(found.study, rows).items() if claim.ok}
    return sorted(claim.sentence for key, claim in found.own.items() if not np.isfinite(claim.value) or key in nothing)


def far(found):
    """Claims whose limit is more than three times the value without a reason, and reasons of none or of few words."""
    reasons = getattr(found.study, "REASONS", {})
    sentences = [claim.sentence for claim in found.own.values()]
    loose = [claim.sentence for claim in found.own.values() if claim.ok and claim.room > NEAR]
    unused = [words for words in reasons if not any(words in sentence for sentence in sentences)]
    silent = [words for words, reason in reasons.items() if len(reason.split()) < 4]
    return sorted(s for s in loose if not any(words in s for words in reasons)) + unused + silent


def unexplained(found):
    """Claims that fail without a reason in the study's `FAILS`, and reasons of none that fails."""
    return explained.unexplained(found.study, found.own.values())


NAMES = [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in STORED]


# What is asked, and what is wrong of the claims that it names.
ASKED = {
    holding_anyhow: "hold whatever the rows are, so that they say nothing: set nearer limits, or make them `notes`",
    without_rows: "hold without any rows, or have no number for a value",
    far: "have limits of more than three times the value, and `REASONS` does not say why, or by words of no claim or "
    "in less than four words",
    unexplained: "fail, and `FAILS` does not say why; or its words are of none that fails",
}


def said(name, refused, found):
    """What is wrong, in a sentence; empty if nothing is."""
    return f"claims of {name} {ASKED[refused]} (docs/decisions/claims.md): {'; '.join(found)}" if found else ""


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("refused", ASKED)
def test_claims_can_fail(name, refused):
    assert not (wrong := said(name, refused, refused(stored(name)))), wrong


def test_the_manual_s_own_study_passes():
    """`docs/studies.md`, with all its rows."""
    study = ModuleType("mine")
    exec(next(block.text for block in blocks("studies.md") if "CASES" in block.text), study.__dict__)
    rows = [case | {"status": "ok", "note": ""} | study.run(**case) for case in study.CASES]
    found = judged(study, pd.DataFrame(rows))
    assert len(found.own) == 3 and all(claim.ok for claim in found.own.values())
    assert [said("mine", refused, refused(found)) for refused in ASKED if refused(found)] == []


def made_up(reasons=None, fails=None, **claims):
    """A study of twenty rows whose error falls with their size, and claims by their sentences: value and limit."""
    size = np.arange(1.0, 21.0)
    df = pd.DataFrame({"size": size, "error": 1 / size, "cost": 1e-3 * size, "status": "ok", "note": ""})
    told = {"claims": lambda df: ((text, value(df), limit) for text, (value, limit) in claims.items())}
    return judged(SimpleNamespace(CASES=[{"size": 1.0}], REASONS=reasons or {}, FAILS=fails or {}, **told), df)


def test_claims_that_cannot_fail_are_refused():
    found = made_up(
        finest=(lambda df: df[df["size"] > 15]["error"].max(), 0.1),
        worst=(lambda df: df["error"].max(skipna=False), 2.0),
        ratio=(lambda df: df["cost"].iloc[-1] / df["cost"].iloc[0], ">= 10"),
        rows=(lambda df: len(df), ">= 10"),
        wide=(lambda df: df[df["size"] > 15]["error"].max(), 5.0),
        wrong=(lambda df: (df["error"] > 2).sum(), "= 0"),
        infinite=(lambda df: np.inf * df["cost"].iloc[0], ">= 1"),
    )
    # What is counted is asked when it is tenfold, but holds without rows.
    assert holding_anyhow(found) == ["rows", "wide"]
    assert without_rows(found) == ["infinite", "rows", "wrong"]
    assert far(found) == ["infinite", "wide"]


def test_reasons_are_of_claims_and_have_words():
    claims = {"wide": (lambda df: df["error"].max(), 5.0)}
    assert far(made_up(**claims)) == ["wide"]
    assert far(made_up({"wide": "the rounding of twenty sums"}, **claims)) == []
    assert far(made_up({"wide": "rounding", "gone": "the rounding of twenty sums"}, **claims)) == ["gone", "wide"]


def test_what_fails_is_explained():
    claims = {"near": (lambda df: df["error"].max(), 0.5), "wide": (lambda df: df["error"].max(), 2.0)}
    assert unexplained(made_up(**claims)) == ["near"]
    assert unexplained(made_up(fails={"near": "nobody knows why"}, **claims)) == []
    assert unexplained(made_up(fails={"near": "nobody knows why", "wide": "it holds"}, **claims)) == ["wide"]
