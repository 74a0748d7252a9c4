"""The searches on a second machine: who wins there.

    python -m studies.frontier.second OUT/frontier.csv

keeps of rows that were made elsewhere what they reach, and at what cost, in `second.csv` beside this file. A scene of
which a way was disturbed there, or is missing, is left out whole.
"""

from __future__ import annotations

import csv
import statistics
import sys
from pathlib import Path

from demheat.runtime.paths import replaced
from studies.common.searches import means
from studies.common.searches.search import TARGETS
from studies.harness.sound import NOISY

FILE = Path(__file__).with_name("second.csv")
KEPT = ("scene", "way", "seconds", "conductivity", "extrapolated", "trail")
KEPT += ("noise", "triad_gbs", "commit", "when", "machine", "host")
NAMES = {"dem": "the DEM", "fem": "finite elements", "fft": "the FFT"}
# Accuracies at which it is told who wins, %.
TOLD = (1.0, 0.1, 0.01)


def keep(path):
    """Write what is kept of rows that nobody disturbed; their number."""
    csv.field_size_limit(sys.maxsize)
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row.get("trail") and float(row["noise"]) <= NOISY]
    with replaced(FILE) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, KEPT, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    return len(rows)


def there():
    """Rows of the second machine; None without them."""
    import pandas as pd

    return pd.read_csv(FILE) if FILE.exists() else None


def whole(df, other):
    """Scenes of which every way that was searched here was searched there, with as many seconds."""
    keys = ["scene", "way", "seconds"]
    made = (means.longest(rows[rows["trail"].notna()]) for rows in (df, other))
    here, elsewhere = (set(map(tuple, rows[keys].to_numpy())) for rows in made)
    return [scene for scene in means.scenes_of(df) if {each for each in here if each[0] == scene} <= elsewhere]


def reached(df, other):
    """Ways that get there, the cheapest first, here and there, by scene and accuracy."""
    scenes = whole(df, other)
    return {
        (scene, target): [means.reached(rows, scene, "conductivity", target) for rows in (df, other)]
        for target in TARGETS
        for scene in means.judged(df, "conductivity", target)
        if scene in scenes
    }


def compared(ways):
    """The cheapest here and there, wherever somebody gets there on both."""
    return {key: [means.best_of(each) for each in both] for key, both in ways.items() if all(both)}


def families(best):
    """Methods that are the cheapest, or tie."""
    return {each.family for each in best.tied}


def others(pairs):
    """Pairs on which another method is the cheapest, with no tie on either machine that would make it the same."""
    return {key: both for key, both in pairs.items() if not families(both[0]) & families(both[1])}


def alone(pairs, number, name, target):
    """On how many pairs to an accuracy a method wins without a tie, here (0) or there (1)."""
    return sum(families(both[number]) == {name} for (_, to), both in pairs.items() if to == target)


def factors(ways):
    """By method how many times the cost is there, for the same accuracy, in the median over scenes and accuracies."""
    found: dict = {}
    for both in ways.values():
        here, elsewhere = ({each.way: each for each in some} for some in both)
        for way in here.keys() & elsewhere.keys():
            found.setdefault(here[way].family, []).append(elsewhere[way].cpu_s / here[way].cpu_s)
    return {name: statistics.median(each) for name, each in found.items()}


def in_words(df):
    """What came of it, as sentences; empty without rows."""
    other = there()
    if other is None:
        return ""
    ways = reached(df, other)
    pairs = compared(ways)
    slower = ", ".join(f"{value:.2g} ({NAMES[name]})" for name, value in sorted(factors(ways).items()))
    scenes = {scene for scene, _ in ways}
    out = [scene for scene in means.scenes_of(df) if scene not in scenes]
    return (
        f"The searches on {len(scenes)} scenes were made once more on a second machine, with the same seconds, by "
        f"commit {other['commit'].iat[0]} (of {', '.join(out)} rows are missing or disturbed there). There the same "
        f"accuracy costs {slower} times as much, in the median. {_kept(pairs)} {_moved(pairs, ways)}"
    )


def _kept(pairs):
    """Who wins alone, here and there, by accuracy."""
    parts = [
        f"to {target:g} % {', '.join(f'{NAMES[name]} on {_both(pairs, name, target)}' for name in NAMES)}"
        for target in TOLD
    ]
    return f"Without a tie win, here and there, where somebody gets there on both: {'; '.join(parts)}."


def _both(pairs, name, target):
    return f"{alone(pairs, 0, name, target)} and {alone(pairs, 1, name, target)}"


def _moved(pairs, ways):
    """How many pairs have other winners, and how many only one machine knows."""
    other = {key: both for key, both in pairs.items() if families(both[0]) != families(both[1])}
    told = "; ".join(
        f"{scene} to {target:g} % ({one.first.title} here, {two.first.title} there)"
        for (scene, target), (one, two) in others(pairs).items()
    )
    here, elsewhere = (sum(bool(both[k]) and not both[1 - k] for both in ways.values()) for k in (0, 1))
    return (
        f"Of all {len(pairs)} pairs of scene and accuracy {len(other)} have other winners or ties, {len(others(pairs))}"
        f" of them none in common{f' ({told})' if told else ''}; {here} are reached here alone, {elsewhere} there."
    )


def claims(df):
    """Whether who wins is a matter of the machine; the limit was set before the second one's rows were compared.

    That a scene with gaps in its rows there is left out was chosen when they had been.
    """
    other = there()
    if other is not None and means.searched(df):
        pairs = compared(reached(df, other))
        text = "Pairs of scene and accuracy whose cheapest method is another on a second machine, share"
        yield text, len(others(pairs)) / len(pairs), 0.1


if __name__ == "__main__":
    print(keep(sys.argv[1]), "rows")
