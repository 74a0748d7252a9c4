"""`demheat judge mine.json`: what answers of any program to the benchmark's scenes are worth, as a table and a page."""

import json
from functools import cache
from pathlib import Path

import numpy as np

from demheat import version
from demheat.io.answers import read_answers
from demheat.io.words import nearest
from demheat.runtime.paths import check_output, made_folder, replaced
from demheat.terminal.commands.board import page
from demheat.terminal.commands.scores import Score, scores_of, short, standings
from demheat.terminal.commands.words import aligned, typed

OUT = "demheat-out"
# To which programs are compared by what they cost, if nothing else is said.
ACCURACY = 1e-2
# Of a clone, beside the package.
SCENES = Path(version.__file__).parents[1] / "benchmark" / "scenes"


def run(options) -> int:
    """Judge, print and store; the exit status."""
    accuracy = ACCURACY if options.accuracy is None else options.accuracy
    folder = typed("--out", options.out or OUT, check_output)
    files = [read_answers(path) for path in options.files]
    names = [each.program for each in files]
    if len(set(names)) < len(names):
        raise ValueError(f"{options.files[-1]}: program {names[-1]!r}: each file must be of a program of its own")
    read = reader(options.scenes)
    scores = [score for answers in files for score in scores_of(answers, read)]
    for answers in files:
        own = [score for score in scores if score.program == answers.program]
        print(f"{answers.path}: {' '.join(filter(None, (answers.program, answers.version)))}, {summary(own)}\n")
        print(table(own) + "\n")
    if len(files) > 1:
        print(leaders(scores, accuracy) + "\n")
    path = made_folder(folder) / (f"{files[0].path.stem}.html" if len(files) == 1 else "leaderboard.html")
    with replaced(path) as part:
        part.write_text(page(files, scores, accuracy), encoding="utf-8")
    print(f"page {path}")
    return 0


def reader(folder=None):
    """What reads the table of a scene by its name."""
    home = SCENES if folder is None else Path(folder)
    names = sorted(path.stem for path in home.glob("*.json"))
    if not names:
        raise ValueError(
            f"{home}: holds no scenes; they belong to a clone of demheat, whose benchmark/scenes --scenes must name"
        )

    @cache
    def read(name):
        if name not in names:
            raise ValueError(f"there is no scene {name!r} in {home}{nearest(name, names)}")
        return json.loads((home / f"{name}.json").read_text(encoding="utf-8"))

    return read


def summary(scores: list[Score]) -> str:
    """All answers in a line."""
    told = [score for score in scores if not score.refused]
    errors = np.abs([score.error for score in told])
    said = [f"{_counted(len(told), 'answer')} to {_counted(len({score.scene for score in told}), 'scene')}"]
    if len(told) < len(scores):
        said.append(f"{len(scores) - len(told)} refused")
    if told:
        said.append(f"median error {100 * np.median(errors):.2g} %, worst {100 * errors.max():.2g} %")
    intervals = [score.holds for score in told if score.holds is not None]
    if intervals:
        said.append(f"{sum(intervals)} of {len(intervals)} intervals hold")
    broken = sum(bool(score.beyond) for score in told)
    return "; ".join([*said, f"{broken} beyond certain bounds"] if broken else said)


def _counted(number, name):
    return f"{number} {name}{'' if number == 1 else 's'}"


def table(scores: list[Score]) -> str:
    """A line for each answer."""
    lines = [("scene", "resolution", "error, %", "known to", "interval", "CPU s", "MiB", "remarks")]
    for score in scores:
        words = (short(score.error, 100), short(score.known_to, 100), score.interval)
        lines.append((score.scene, score.resolution, *words, short(score.cost), short(score.memory_mib), score.remarks))
    return aligned(lines)


def leaders(scores: list[Score], accuracy: float) -> str:
    """Programs in the order of how many scenes they know to an accuracy, and of what that costs."""
    lines = [("program", f"to {100 * accuracy:g} %", "of", "times the cheapest", "cheapest on")]
    for each in standings(scores, accuracy):
        lines.append((each.program, str(each.reached), str(each.asked), short(each.factor), str(each.first)))
    return aligned(lines)
