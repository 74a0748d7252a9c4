"""The searches on a second machine: whether the same methods win there.

    python -m studies.frontier.second OUT/frontier.csv

keeps of rows that were made elsewhere what they reach, and at what cost, in `second.csv` beside this file.
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
KEPT = ("scene", "way", "seconds", "conductivity", "extrapolated", "temperature", "noise", "commit", "when", "machine")
NAMES = {"dem": "the DEM", "fem": "finite elements", "fft": "the FFT"}


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


def reached(df, other):
    """Ways that get there, the cheapest first, here and there, by scene and accuracy."""
    return {
        (scene, target): [means.reached(rows, scene, "conductivity", target) for rows in (df, other)]
        for target in TARGETS
        for scene in means.judged(df, "conductivity", target)
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
    same = sum(families(one) == families(two) for one, two in pairs.values())
    slower = ", ".join(f"{value:.2g} ({NAMES[name]})" for name, value in sorted(factors(ways).items()))
    told = "; ".join(
        f"{scene} to {target:g} % ({one.first.title} here, {two.first.title} there)"
        for (scene, target), (one, two) in others(pairs).items()
    )
    gone = [scene for scene in means.scenes_of(df) if scene not in set(other["scene"])]
    without = f" (but {', '.join(gone)})" if gone else ""
    rest, another = len(pairs) - same - len(others(pairs)), len(others(pairs))
    return (
        f"The searches{without} were made once more on a second machine, with the same seconds, by commit "
        f"{other['commit'].iat[0]}. There the same accuracy costs {slower} times as much in the median, so less is "
        f"reached. Of {len(pairs)} pairs of scene and accuracy to which some method for any shape gets on both, the "
        f"cheapest is the same on {same}, with a tie on one of the machines on {rest}, and another on {another}"
        f"{': ' if told else ''}{told}."
    )


def claims(df):
    """Whether who wins is a matter of the machine; the limit was set before the second one's rows were compared."""
    other = there()
    if other is not None and means.searched(df):
        pairs = compared(reached(df, other))
        text = "Pairs of scene and accuracy whose cheapest method is another on a second machine, share"
        yield text, len(others(pairs)) / len(pairs), 0.1


if __name__ == "__main__":
    print(keep(sys.argv[1]), "rows")
