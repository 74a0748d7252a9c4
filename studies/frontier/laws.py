"""Laws of error and cost, fitted to searches; `python -m studies.frontier.laws` ships them anew.

The laws and their terms are those of `demheat.cheapest.cost_laws`. They are fitted to what searches tried on scenes
that are not held back: the steady ones, and some that are there for the laws alone (`scenes.FOR_LAWS`). Logarithms are
fitted by least squares that count large deviations less (an error may cross zero by luck), each scene by as much as any
other, with a little pull of every exponent of a scene's measure towards none: there are few scenes.
"""

import csv
import json
import math
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from demheat.cheapest import cost_laws as shipped
from demheat.cheapest.measures import Measures
from demheat.cheapest.ways import law_and_measures
from studies.common.searches import means
from studies.common.searches.scenes import FOR_LAWS, STEADY, scene_of
from studies.common.searches.ways import WAYS
from studies.frontier import halves

# The way that each method's law is fitted to; rules of the FFT are told apart by the scene.
FITTED = {"dem": "dem", "fem": "fem", "fft": "fft-loose", "multipole": "multipole-loose"}
# Coarser than that nothing begins: what so few elements miss they do not show.
COARSEST = {"particles": 1000, "voxels": 24}
# Relative errors below, a thirtieth of the finest target, are those of the linear solvers: of layers with most methods.
FLOOR = 1e-6
# The matrix does not notice that coated sphere: first-order errors of the conductivity cancel, as of no other scene.
NEUTRAL = ("thin shell",)
# Pull towards zero of the exponents of measures, of which nothing is known, and of those whose order is known.
PULL = (0.0, 0.3, 0.5, 0.5, 0.5, 0.5)
START = (0.0, 2.0, 0.0, 0.0, 0.0, 0.0)
STIFF = 0.3
# Parts of a cost that are the same by all rules of a method.
PAINTED = ("searched", "each_searched", "asked")
# Shares of a cost or a memory below which nothing is told of a part of it.
LEAST = 1e-6
SHARE = 0.9
DIGITS = ".6g"


class Tried(NamedTuple):
    """A value that was tried."""

    scene: str
    measures: Measures
    value: float  # Of the law's knob; sizes in m
    error: float  # Relative
    cpu_s: float
    bytes: float  # At the peak; not-a-number where nobody kept it


def fitted(df):
    """Laws of all methods, by name."""
    found: dict = {}
    for method, way in FITTED.items():
        for tried in _tried(df, method, way):
            found.setdefault(_law_of(method, tried.scene)[0], []).append(tried)
    laws = {name: _law(name, tried) for name, tried in sorted(found.items())}
    shown = _shown()
    laws = {name: law._replace(**_law_of_halves(law, shown.get(name, ()))) for name, law in laws.items()}
    return {name: _with_siblings(law, laws.values()) for name, law in laws.items()}


def _shown():
    """Intervals by the name of the law, half of them in the place of errors."""
    found: dict = {}
    with halves.FILE.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            name, m = law_and_measures(row["method"], halves.part_of(row["scene"], row["method"]))
            half = float(row["half"])
            if half > FLOOR and row["scene"] not in NEUTRAL:
                found.setdefault(name, []).append(Tried(row["scene"], m, float(row["value"]), half, math.nan, math.nan))
    return found


def _law_of_halves(law, shown):
    """Fields of a law that tell of half of its intervals."""
    names = ("half", "half_refinement", "half_strength", "half_contrast", "half_fraction", "half_gap", "half_within")
    if not shown:
        powers = (law.error, law.refinement, law.strength, law.contrast, law.fraction, law.gap, law.error_within)
        return dict(zip(names, powers, strict=True))
    terms = np.array([shipped.error_terms(law.knob, each.measures, each.value) for each in shown])
    (first, *others), spread = _fit(terms, np.log([each.error for each in shown]), _weights(shown))
    return dict(zip(names, (float(np.exp(first)), *map(float, others), spread), strict=True))


def _with_siblings(law, laws):
    """Surfaces that no scene of one rule has cost what they do by another: all are painted alike."""
    family = [each for each in laws if each.method.split("-")[0] == law.method.split("-")[0]]
    found = {name: max(getattr(each, name) for each in family) for name in PAINTED if getattr(law, name) == 0}
    return law._replace(**found)


@cache
def _law_of(method, scene):
    """Name of the law, and the measures that it is asked of."""
    return law_and_measures(method, scene_of(scene))


def _tried(df, method, way):
    rows = means.longest(df[df["way"] == way])
    for row in rows[rows["scene"].isin([*STEADY, *FOR_LAWS])].to_dict("records"):
        if not isinstance(row.get("trail"), str):
            continue
        measures = _law_of(method, row["scene"])[1]
        unit = measures.edge if WAYS[way].knob == "size" else 1.0
        coarsest = COARSEST.get(WAYS[way].knob, 0.0)
        every = json.loads(row["conductivity"]).values()
        peaks = {told[0]: told[3] for told in every if isinstance(told, list) and told[3] is not None}
        for value, _, _, found, *_ in json.loads(row["trail"]):
            if found and found[0] is not None and value >= coarsest:
                peak = peaks.get(value, math.nan) * 2**20
                yield Tried(row["scene"], measures, unit * value, found[0] / 100, found[1], peak)


def _law(name, tried):
    knob = WAYS[FITTED[name.split("-")[0]]].knob
    sizes = np.array([shipped.size_terms(knob, each.measures, each.value) for each in tried])
    sound = [each for each in tried if each.error > FLOOR and each.scene not in NEUTRAL]
    terms = np.array([shipped.error_terms(knob, each.measures, each.value) for each in sound])
    error, spread = _fit(terms, np.log([each.error for each in sound]), _weights(sound))
    parts, stiff, cost_spread = _costs(sizes, tried)
    each_bytes, bytes_spread = _memory(sizes[:, 1:4], np.array([each.bytes for each in tried]))
    edges = [each.value / (each.measures.edge if knob == "size" else 1.0) for each in tried]
    ends = sorted((min(edges), max(edges)), reverse=knob == "size")
    return shipped.Law(
        name, knob, *ends, np.exp(error[0]), *error[1:], spread, *[math.nan] * 7, *parts, stiff, cost_spread,
        *each_bytes, bytes_spread,
        len(tried), len({each.scene for each in tried}),
    )  # fmt: skip


def _weights(tried):
    """Of values, so that each scene counts as much as any other, (n,) float array, 1 in the mean square."""
    names, number = np.unique([each.scene for each in tried], return_inverse=True)
    weights = 1 / np.sqrt(np.bincount(number)[number])
    return weights * math.sqrt(len(tried) / len(names))


def _fit(terms, logs, weights):
    """Powers of the terms, and the factor within which nine of ten values are."""
    from scipy.optimize import least_squares

    start, pull = np.array(START), np.array(PULL)

    def residuals(powers):
        return np.concatenate([weights * (terms @ powers - logs), pull * (powers - start)])

    found = least_squares(residuals, start, loss="soft_l1", x_scale="jac").x
    return found, within(np.exp(terms @ found - logs))


def _costs(sizes, tried):
    """Seconds of each part of the work, the exponent of the contrast, and the factor."""
    from scipy.optimize import least_squares, nnls

    seconds, weights = np.array([each.cpu_s for each in tried]), _weights(tried)
    stiff = np.array([shipped.stiff_term(each.measures) for each in tried])
    scale = weights / seconds
    begin = nnls(sizes * scale[:, None], weights)[0]
    # What tells nothing there has no part.
    there = np.max(sizes * begin / seconds[:, None], axis=0) > LEAST

    def residuals(powers):
        # A step too far ends in infinity, and is made shorter.
        with np.errstate(over="ignore"):
            found = sizes[:, there] @ np.exp(powers[1:])
        return np.append(weights * (np.log(found / seconds) + powers[0] * stiff), STIFF * powers[0])

    found = least_squares(residuals, np.append(0.0, np.log(begin[there])), loss="soft_l1", x_scale="jac").x
    parts = np.zeros(len(begin))
    parts[there] = np.exp(found[1:])
    parts[np.max(sizes * parts / seconds[:, None], axis=0) < LEAST] = 0.0
    return parts, found[0], within((sizes @ parts) * np.exp(found[0] * stiff) / seconds)


def _memory(sizes, found):
    """Bytes of volume, surface and inclusions, by relative deviations, and the factor."""
    from scipy.optimize import nnls

    known = np.isfinite(found) & (found > 0)
    parts = nnls(sizes[known] / found[known, None], np.ones(known.sum()))[0]
    return parts, within(sizes[known] @ parts / found[known])


def within(ratios, share=SHARE):
    """Factor, 1 or more, within which a share of ratios is."""
    return float(np.exp(np.quantile(np.abs(np.log(ratios)), share)))


def written(found):
    """Laws as the text of a file."""
    lines = [",".join(shipped.Law._fields)]
    lines += [",".join(map(_word, law)) for law in found.values()]
    return "\n".join(lines) + "\n"


def _word(value):
    return format(value, DIGITS) if isinstance(value, float) else str(value)


def ship(csv_path, file=shipped.FILE):
    """Fit the laws to stored rows and write the file that the package ships; returns its path."""
    import pandas as pd

    from demheat.runtime.paths import replaced

    with replaced(file) as temporary:
        temporary.write_text(written(fitted(pd.read_csv(csv_path))), encoding="utf-8")
    return Path(file)


if __name__ == "__main__":
    print(ship(sys.argv[1] if len(sys.argv) > 1 else Path("results") / "frontier.csv"))
