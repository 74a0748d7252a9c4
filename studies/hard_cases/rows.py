"""All methods on one hard scene as a row."""

from __future__ import annotations

import json
from collections import Counter

from demheat.referee import value_error
from studies.common.answers import answer
from studies.hard_cases.changes import relations
from studies.hard_cases.scenes import rng_of, scene_of
from studies.hard_cases.verdicts import OUTCOMES, Truth, judged, refused, truth
from studies.hard_cases.ways import allowed, ways
from studies.harness import methods


def steady(family: str, seed: int, changed: bool = False) -> dict:
    """Verdicts on one scene by all methods."""
    scene, _, refusal = answer(lambda: scene_of(family, seed))
    if refusal is not None:
        return row_of([refused("scene", refusal)], "none")
    known = truth(scene)
    taken = ways(family, scene, rng_of(family, seed, 1))
    verdicts = [asked(way, scene, known) for way in taken]
    row = row_of(verdicts, known.source, known)
    if not changed:
        return row
    right = [way for way, each in zip(taken, verdicts, strict=True) if each.outcome == "verified" and not each.note]
    return row | relations(scene, right, rng_of(family, seed, 2))


def asked(way, scene, known: Truth):
    """Verdict on one method."""
    solve = methods.load(way.method.module).solve
    field, said, refusal = answer(lambda: solve(scene, **way.knobs))
    if refusal is not None:
        return refused(way.name, refusal)
    return judged(way.name, field, known, allowed(way, scene), said)


def row_of(verdicts, source: str, known: Truth | None = None) -> dict:
    """Verdicts as a row: counts, the worst that was not said, and all in one cell."""
    counts = Counter(each.outcome for each in verdicts)
    wrong = [each for each in verdicts if each.outcome == "wrong"]
    words = "; ".join(f"{each.method} {100 * each.error:+.3g} % {each.note}".strip() for each in wrong)
    row = {"cases": len(verdicts), **{name: counts[name] for name in OUTCOMES}, "truth": source}
    if known is not None and known.lower > 0:
        row["width_percent"] = 100 * float(value_error(known.upper, known.lower))
    return row | {
        "wrongs": words,
        "relations": 0,
        "broken": 0,
        "verdicts": json.dumps([tuple(each) for each in verdicts]),
    }
