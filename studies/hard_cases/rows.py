"""All methods on one hard scene as a row."""

import json
from collections import Counter

from demheat.referee import value_error
from demheat.runtime.process_state import stopwatch
from studies.common.answers import answer
from studies.hard_cases.changes import relations
from studies.hard_cases.scenes import rng_of, scene_of, spheres_of
from studies.hard_cases.verdicts import OUTCOMES, Truth, judged, refused, truth
from studies.hard_cases.ways import ways
from studies.harness import methods

# Processor seconds within which a refusal must come.
SOON = 10.0
# Who is true is not judged.
WITNESSES = {"multipoles": "multipole"}


def steady(family: str, seed: int, changed: bool = False) -> dict:
    """Verdicts on one scene by all methods."""
    scene, _, refusal = answer(lambda: scene_of(family, seed))
    if refusal is not None:
        return row_of([refused("scene", refusal)], "none")
    known = truth(spheres_of(family, seed))
    taken = [way for way in ways(family, scene, rng_of(family, seed, 1)) if WITNESSES.get(known.source) != way.name]
    verdicts, seconds = zip(*(asked(way, scene, known) for way in taken), strict=True)
    late = sum(each.outcome == "refused" and spent > SOON for each, spent in zip(verdicts, seconds, strict=True))
    row = row_of(verdicts, known.source, known) | {"late": late}
    if not changed:
        return row
    right = [way for way, each in zip(taken, verdicts, strict=True) if each.outcome == "verified" and not each.note]
    return row | relations(scene, right, rng_of(family, seed, 2))


def asked(way, scene, known: Truth):
    """Verdict on one method, and processor seconds until it answered."""
    solve, spent = methods.load(way.method.module).solve, stopwatch()
    field, said, refusal = answer(lambda: solve(scene, **way.knobs))
    seconds = spent()["cpu_s"]
    if refusal is not None:
        return refused(way.name, refusal), seconds
    return judged(way.name, field, known, said), seconds


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
