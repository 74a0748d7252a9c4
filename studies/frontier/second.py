"""The searches on another machine: who wins there, and who if no way is the FFT's alone.

    python -m studies.frontier.second keep OUT

keeps of rows that `python -m studies run frontier --out OUT --force` made on another machine what they reach, and at
what cost, in `second.csv` beside this file, with what it has already of other scenes;

    python -m studies.frontier.second make OUT

searches by the ways that the record has on few scenes or none (`cases.second_cases`) beside such rows, and

    python -m studies.frontier.second more OUT

keeps of all of them the same in `more_ways.csv`. A scene of which a way was disturbed there, or is missing, is left
out whole.
"""

import csv
import statistics
import sys
from pathlib import Path

from demheat.runtime.paths import replaced
from studies.common.searches import means
from studies.common.searches.scenes import SCENES
from studies.common.searches.search import TARGETS
from studies.common.searches.ways import WAYS
from studies.frontier.cases import second_cases
from studies.harness.sound import NOISY

FILE = Path(__file__).with_name("second.csv")
MORE = Path(__file__).with_name("more_ways.csv")
KEPT = ("scene", "way", "seconds", "conductivity", "extrapolated", "trail")
KEPT += ("noise", "triad_gbs", "commit", "when", "machine", "host")
NAMES = {"dem": "the DEM", "fem": "finite elements", "fft": "the FFT"}
# Accuracies at which it is told who wins, %.
TOLD = (1.0, 0.1, 0.01)


def make(out):
    """Search by the further ways on this machine; rows that are there already stay."""
    from studies.harness import runner

    study = runner.load("frontier")
    study.CASES = study.FURTHER
    return runner.run_study("frontier", out)


def keep(out, path):
    """Write what is kept of rows that nobody disturbed, beside those of other scenes; their number."""
    rows = [row for row in _rows(Path(out) / "frontier.csv") if float(row["noise"]) <= NOISY]
    again = {row["scene"] for row in rows}
    rows = [*(row for row in _rows(path) if row["scene"] not in again), *rows]
    with replaced(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, KEPT, extrasaction="ignore", lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    return len(rows)


def _rows(path):
    """Searches in a file; none without it."""
    csv.field_size_limit(sys.maxsize)
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if row.get("trail")]


def there(path):
    """Rows of a file; None without it."""
    import pandas as pd

    return pd.read_csv(path) if path.exists() else None


def searches(rows):
    """Seconds of what was searched by ways for any shape, which alone are compared, by scene and way."""
    every = means.longest(rows[rows["trail"].notna()])[list(KEPT[:3])].to_numpy()
    return {(scene, way): seconds for scene, way, seconds in every if not WAYS[way].spheres}


def whole(wanted, other):
    """Scenes of which every one of the wanted searches was made there, in however many seconds."""
    return {scene for scene, _ in wanted} - {scene for scene, _ in set(wanted) - set(searches(other))}


def reached(df, other):
    """Ways that get there, the cheapest first, here and there, by scene and accuracy."""
    return _pairs(df, df, _without_more(df, other), whole(searches(df), other))


def fairer(df, other):
    """The same, both on one machine: by the record's ways, and by those of `cases.second_cases`, too."""
    wanted = {*searches(df), *((case["scene"], case["way"]) for case in second_cases())}
    return _pairs(df, _without_more(df, other), other, whole(wanted, other))


def _without_more(df, other):
    """Rows of ways that the record has on the same scene."""
    known = searches(df)
    return other[[each in known for each in zip(other["scene"], other["way"], strict=True)]]


def _pairs(df, one, two, scenes):
    both = {scene: [means.searches_of(rows, scene, "conductivity") for rows in (one, two)] for scene in scenes}
    return {
        (scene, target): [means.reaching(rows, "conductivity", target) for rows in both[scene]]
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
        here, elsewhere = ({(each.way, each.extrapolated): each for each in some} for some in both)
        for key in here.keys() & elsewhere.keys():
            found.setdefault(here[key].family, []).append(elsewhere[key].cpu_s / here[key].cpu_s)
    return {name: statistics.median(each) for name, each in found.items()}


def on_a_second_machine(df):
    """Whether the same methods win there."""
    other = there(FILE)
    if other is None:
        return ""
    ways = reached(df, other)
    pairs = compared(ways)
    slower = ", ".join(f"{value:.2g} ({NAMES[name]})" for name, value in sorted(factors(ways).items()))
    scenes = _scenes(ways)
    out = [scene for scene in means.scenes_of(df) if scene not in scenes]
    lacking = f" (of {', '.join(out)} rows are missing or disturbed)" if out else ""
    return (
        f"The searches on {len(scenes)} scenes were made on another machine as well ({_where(other)}), with "
        f"{_seconds(df, other)}{lacking}. "
        f"There the same accuracy costs {slower} times as much, in the median. {_kept(pairs)} {_moved(pairs, ways)}"
    )


def _where(rows):
    """Which machine made rows, and by which commits."""
    machines, commits = (", ".join(sorted(set(rows[name]))) for name in ("machine", "commit"))
    return f"{machines}; commits {commits}"


def _seconds(df, other):
    """Whether searches on both machines were given as much."""
    here, elsewhere = searches(df), searches(other)
    both = {each for each in here.keys() & elsewhere.keys() if each[0] in SCENES}
    unlike = sum(here[each] != elsewhere[each] for each in both)
    return f"the same seconds but for {unlike} of {len(both)}" if unlike else "the same seconds"


def _kept(pairs, how="here and there"):
    """Who wins alone, one way and the other, by accuracy."""
    parts = [
        f"to {target:g} % {', '.join(f'{NAMES[name]} on {_both(pairs, name, target)}' for name in NAMES)}"
        for target in TOLD
    ]
    return f"Without a tie win, {how}, where somebody gets there on both: {'; '.join(parts)}."


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


def _scenes(ways):
    return dict.fromkeys(scene for scene, _ in ways)


def with_more_ways(df):
    """Whether the same methods win where no way is the FFT's alone."""
    other = there(MORE)
    ways = {} if other is None else fairer(df, other)
    if not ways:
        return ""
    pairs = compared(ways)
    moved = {key: both for key, both in pairs.items() if families(both[0]) != families(both[1])}
    told = "; ".join(
        f"{scene} to {target:g} % ({_names(one)} before, {_names(two)} with them)"
        for (scene, target), (one, two) in moved.items()
    )
    return (
        f"A tolerance of 1e-3 is searched for in the record by the FFT alone of methods for any shape, and what the "
        f"DEM is extrapolated to on few scenes. In searches beside it, on one machine ({_where(other)}), the DEM and "
        f"elements were given such a tolerance on {len(_scenes(ways))} scenes, and the DEM its extrapolation on all of "
        f"these. "
        f"{_kept(pairs, 'without these ways and with them')} "
        f"Of {len(pairs)} pairs of scene and accuracy {len(moved)} have other winners or ties with them"
        f"{f': {told}' if told else ''}."
    )


def _names(best):
    return " and ".join(NAMES[name] for name in sorted(families(best)))


def claims(df):
    """Whether who wins is a matter of the machine, or of ways that are the FFT's alone.

    Limits were set before rows were compared; that a scene with gaps in its rows there is left out was chosen when
    those of the first had been.
    """
    if not means.searched(df):
        return
    for path, both, where in (
        (FILE, reached, "on a second machine"),
        (MORE, fairer, "where all have a loose tolerance and the DEM is extrapolated, on one machine"),
    ):
        other = there(path)
        pairs = {} if other is None else compared(both(df, other))
        text = f"Pairs of scene and accuracy with no winner in common {where}, share"
        if pairs:
            yield text, len(others(pairs)) / len(pairs), 0.1


if __name__ == "__main__":
    command, folder = sys.argv[1:]
    print(make(folder) if command == "make" else keep(folder, {"keep": FILE, "more": MORE}[command]))
