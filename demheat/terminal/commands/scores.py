"""What answers to scenes of the benchmark are worth: errors, bounds, symmetry, intervals, and costs as declared."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from demheat.io.answers import Answers
from demheat.io.known import known_of, scene_of
from demheat.terminal.commands.bounds import bounds_of

# Of a bound: what tolerances of solvers may take a right value beyond it.
ROUNDING = 1e-6


class Score(NamedTuple):
    """One answer, judged."""

    program: str
    scene: str
    resolution: str
    error: float = math.nan  # Of the conductivity, or the worst of the temperatures over their span
    known_to: float = math.nan  # The same of what is known: no smaller error can be told
    beyond: str = ""  # Certain bounds that it breaks, in words
    holds: bool | None = None  # Whether its interval holds what is known; None without one
    width: float = math.nan  # Of its interval, over what is known
    asymmetry: float = math.nan  # Of its tensor: largest difference across the diagonal over the largest entry
    cpu_s: float = math.nan
    wall_s: float = math.nan
    memory_mib: float = math.nan
    refused: str = ""

    @property
    def cost(self) -> float:
        """CPU seconds, or those of the clock where these are not declared; NaN without both."""
        return self.wall_s if math.isnan(self.cpu_s) else self.cpu_s

    @property
    def interval(self) -> str:
        """Whether its interval holds, and how wide it is."""
        return "" if self.holds is None else f"{'holds' if self.holds else 'misses'}, {100 * self.width:.2g} % wide"

    @property
    def remarks(self) -> str:
        """What else there is to say."""
        said = [f"refused: {self.refused}"] if self.refused else []
        said += [f"beyond {self.beyond}"] if self.beyond else []
        if self.asymmetry > 0:
            said.append(f"tensor asymmetric by {100 * self.asymmetry:.2g} %")
        return "; ".join(said)


def scores_of(answers: Answers, read: Callable[[str], dict]) -> list[Score]:
    """Every answer of a file, judged; `read` gives the table of a scene by its name, or a ValueError."""
    found = []
    for number, given in enumerate(answers.answers):
        try:
            found.append(_score(answers.program, given, read(given.scene)))
        except ValueError as error:
            raise ValueError(f"{answers.path}: answers[{number}]: {error}") from None
    return found


def _score(program, given, table):
    costs = {name: getattr(given, name) for name in ("cpu_s", "wall_s", "memory_mib")}
    score = Score(program, given.scene, given.resolution, **costs, refused=given.refused)
    if given.refused:
        return score
    known = known_of(table)
    scene = None if "voxels" in table["scene"] else scene_of(table)
    if known.conductivity is None:
        return score._replace(**_of_temperatures(given, known, scene))
    if math.isnan(given.conductivity):
        raise ValueError(f"scene {given.scene!r} asks for a conductivity, which is not there")
    score = score._replace(
        error=given.conductivity / known.conductivity - 1,
        known_to=known.error / known.conductivity,
        beyond=_beyond(given, scene),
    )
    if not math.isnan(given.lower):
        slack = known.error
        holds = given.lower - slack <= known.conductivity <= given.upper + slack
        score = score._replace(holds=holds, width=(given.upper - given.lower) / known.conductivity)
    if given.tensor is not None:
        apart = np.abs(given.tensor - given.tensor.T).max()
        # Of one that is nothing, 0.
        score = score._replace(asymmetry=float(apart / (np.abs(given.tensor).max() or 1.0)))
    return score


def _of_temperatures(given, known, scene):
    wanted = len(known.temperature)
    if given.temperatures is None or len(given.temperatures) != wanted:
        found = "are none" if given.temperatures is None else f"are {len(given.temperatures)}"
        raise ValueError(
            f"scene {given.scene!r} asks for temperatures at its {wanted} points, in their order, and there {found}"
        )
    span = span_of(scene, known.temperature)
    off = given.temperatures - known.temperature
    return {"error": float(off[np.argmax(np.abs(off))]) / span, "known_to": known.temperature_error / span}


def span_of(scene, temperatures: Sequence[float]) -> float:
    """Between which temperatures a body may be, K: those of the load, the start, and those that are known."""
    if scene.periodic:
        return float(np.abs(scene.gradient) @ np.array(scene.size))
    held = [value for value in scene.walls.values() if isinstance(value, float)]
    start = [] if scene.initial is None else [scene.initial]
    return float(np.ptp([*held, *start, *temperatures]))


def _beyond(given, scene):
    """Certain bounds that a conductivity breaks."""
    if scene is None:
        return ""
    for bound in bounds_of(scene):
        if bound.certain and not bound.lower * (1 - ROUNDING) <= given.conductivity <= bound.upper * (1 + ROUNDING):
            return f"{bound.name}: {bound.lower:.6g} to {bound.upper:.6g}"
    return ""


class Standing(NamedTuple):
    """A program on a leaderboard."""

    program: str
    reached: int  # Scenes that it knows to the accuracy
    asked: int  # Scenes that it answers
    factor: float  # Geometric mean of its cost over that of the cheapest, on scenes that it reaches; NaN without costs
    first: int  # Scenes on which it is the cheapest


def cheapest(scores: Sequence[Score], accuracy: float) -> dict[str, list[Score]]:
    """By scene, of each program that knows it to an accuracy the cheapest such answer, the cheapest program first."""
    found = {}
    for score in scores:
        if abs(score.error) <= accuracy:
            mine = found.setdefault(score.scene, {})
            if score.program not in mine or _by_cost(score) < _by_cost(mine[score.program]):
                mine[score.program] = score
    return {scene: sorted(found[scene].values(), key=_by_cost) for scene in sorted(found)}


def standings(scores: Sequence[Score], accuracy: float) -> list[Standing]:
    """Programs by how many scenes they know to an accuracy, then by what that costs beside the cheapest."""
    best = cheapest(scores, accuracy)
    found = []
    for program in dict.fromkeys(score.program for score in scores):
        mine = {scene: next((each for each in row if each.program == program), None) for scene, row in best.items()}
        mine = {scene: score for scene, score in mine.items() if score is not None}
        factors = [score.cost / best[scene][0].cost for scene, score in mine.items() if score.cost > 0]
        factor = math.exp(sum(map(math.log, factors)) / len(factors)) if factors else math.nan
        asked = len({score.scene for score in scores if score.program == program and not score.refused})
        first = sum(best[scene][0] is score and score.cost > 0 for scene, score in mine.items())
        found.append(Standing(program, len(mine), asked, factor, first))
    return sorted(found, key=lambda each: (-each.reached, math.isnan(each.factor), each.factor))


def short(value: float, factor: float = 1.0) -> str:
    """A number in two digits; empty if there is none."""
    return "" if math.isnan(value) else f"{factor * value:.2g}"


def _by_cost(score):
    return math.isnan(score.cost), score.cost
