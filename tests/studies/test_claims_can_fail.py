"""No claim holds whatever the rows are: stored rows are dealt out anew, spoiled and taken away, and limits are near.

Nothing is computed anew. A claim is as good as the worst rows that it accepts:

- it has rows: its value is a number, and it does not hold where all rows are gone or have failed;
- on results that are dealt out anew it fails at least once in ten times. Where they cannot tell (the value is the
  worst that there is, so that any order of the rows is as good) or the limit is within three times the value, it must
  fail when the results are spoiled: ten times as large, a tenth, of the other sign, moved, scattered, denied;
- its limit is within three times the value, or the study's `REASONS` says why not.
"""

from functools import cache
from pathlib import Path

import dealt
import numpy as np
import pytest

from studies.__main__ import study_names
from studies.harness import runner

RESULTS = Path(__file__).parents[2] / "results"
DEALS, KEPT, NEAR = 6, 0.9, 3.0
STORED = [name for name in study_names() if (RESULTS / f"{name}.csv").exists()]
# Studies with such claims still; each leaves this list when it has none.
TO_MEND = ()
# Claims that no order of the rows and no change of the results make fail, and how they could.
EXCEPTIONS = {
    "Cells of 6 D against cells of 9 D": "two means that should not differ: any others dealt to both do not either",
    "100000 particles: values that lower": "a win in every family is rare by chance; with fewer particles it fails",
}


@cache
def claims_of(name):
    """A study with its claims on stored rows, and on rows dealt out anew."""
    study = _light(runner.load(name))
    df = dealt.frame(study, RESULTS / f"{name}.csv")
    deals = [dealt.judged(study, dealt.dealt(study, df, seed)) for seed in range(DEALS)]
    return study, df, dealt.judged(study, df), deals


def _light(study):
    """A study without claims whose judgement takes seconds each time: laws are fitted anew, and have their tests."""
    if study.__name__.endswith("speed_error"):
        from studies.speed_error import verdicts

        verdicts.SCENES = np.inf
    return study


def excepted(claim):
    return any(words in claim.sentence for words in EXCEPTIONS)


def holding_anyhow(name):
    """Sentences of claims that hold, and hold on rows dealt out anew and on spoiled ones, or are too loose to tell."""
    study, df, own, deals = claims_of(name)
    doubtful, found = {}, []
    for key, claim in own.items():
        others = [deal[key] for deal in deals if key in deal]
        if not claim.ok or excepted(claim) or np.mean([other.ok for other in others] or [0]) < KEPT:
            continue
        if not dealt.as_bad(claim, others) and dealt.ratio(claim) > NEAR:
            found.append(claim.sentence)
        doubtful[key] = claim
    for rows in _spoiled(study, df):
        if not doubtful:
            break
        after = dealt.judged(study, rows)
        doubtful = {key: claim for key, claim in doubtful.items() if key not in after or after[key].ok}
    return sorted({*found, *(claim.sentence for claim in doubtful.values())})


def _spoiled(study, df):
    """All results at once; halves of them, for ratios of two; each alone, as others may leave nothing to be judged."""
    yield from (dealt.spoiled(study, df, how) for how in dealt.SPOILS)
    names = [name for name in dealt.results(study, df) if df[name].notna().any()]
    for bit in range(len(names).bit_length()):
        for side in (0, 1):
            yield dealt.spoiled(study, df, "tenfold", [n for k, n in enumerate(names) if k >> bit & 1 == side])
    yield from (dealt.spoiled(study, df, "tenfold", [name]) for name in names)


def without_rows(name):
    study, df, own, _ = claims_of(name)
    nothing = {
        key for rows in (df.iloc[:0], dealt.gone(study, df)) for key, c in dealt.judged(study, rows).items() if c.ok
    }
    return sorted(claim.sentence for key, claim in own.items() if not np.isfinite(claim.value) or key in nothing)


def far(name):
    """Claims whose limit is more than three times the value without a reason, and reasons of no such claim."""
    study, _, own, _ = claims_of(name)
    reasons = getattr(study, "REASONS", {})
    loose = [claim.sentence for claim in own.values() if claim.ok and dealt.ratio(claim) > NEAR]
    unused = [words for words in reasons if not any(words in claim.sentence for claim in own.values())]
    silent = [words for words, reason in reasons.items() if len(reason.split()) < 4]
    return sorted(s for s in loose if not any(words in s for words in reasons)) + unused + silent


@pytest.mark.parametrize("name", STORED)
@pytest.mark.parametrize("found", [holding_anyhow, without_rows, far])
def test_claims_can_fail(name, found):
    if name in TO_MEND:
        pytest.skip("still to be mended")
    assert found(name) == []
