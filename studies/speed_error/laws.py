"""Laws of error and cost, fitted to the rows of steady scenes; `python -m studies.speed_error.laws` ships them anew.

The laws and their terms are those of `demheat.cheapest.cost_laws`. Logarithms are fitted by least squares that count
large deviations less (an error may cross zero by luck), with a little pull of every exponent of a scene's measure
towards none: there are few scenes.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np

from demheat.cheapest import cost_laws as shipped
from demheat.cheapest.measures import measures
from studies.harness import methods
from studies.harness.methods import value_of
from studies.speed_error.scenes import STEADY, scene_of

# Relative errors below, a hundredth of the finest target, are those of the linear solvers: of layers with most methods.
FLOOR = 1e-6
# The matrix does not notice that coated sphere: first-order errors of the conductivity cancel, as of no other scene.
NEUTRAL = ("thin shell",)
# Pull towards zero of the exponents of measures, of which nothing is known, and of those whose order is known.
PULL = {"error": (0.0, 0.3, 0.5, 0.5, 0.5, 0.5), "cost": (0.0, 0.05, 0.3)}
START = {"error": (0.0, 2.0, 0.0, 0.0, 0.0, 0.0), "cost": (0.0, 1.0, 0.0)}
# From so many unknowns on memory is theirs, and not that of what is loaded.
MANY = 5_000
SHARE = 0.9
FEWEST = 5
DIGITS = ".6g"


@cache
def measured(scene):
    """Measures of a scene by its name."""
    return measures(scene_of(scene))


def stored(csv_path):
    """Rows of this study in a file, and those of links beside it."""
    import pandas as pd

    from studies.harness import runner
    from studies.harness.table import read_frame

    files = {"speed_error": csv_path, "speed_error.links": Path(__file__).with_name("links.csv")}
    return pd.concat([read_frame(runner.load(name), path) for name, path in files.items()])


def usable(df):
    """Rows of steady solves that went well, with their method's knob and its value."""
    good = df[df["scene"].isin(STEADY) & (df["status"] == "ok") & (df["name"] != "tessellation")]
    if "tolerance" in good:
        good = good[good["tolerance"].isna()]
    value = np.array([value_of(row) for row in good.to_dict("records")], dtype=float)
    return good.assign(value=value)[np.isfinite(value)]


def fitted(df):
    """Laws of all methods that have enough rows."""
    groups = usable(df).groupby("name", sort=True)
    return {name: _law(name, rows) for name, rows in groups if len(_errors(rows)) >= FEWEST}


def _errors(rows):
    """Rows with an error of the method itself."""
    return rows[_counts(rows["scene"], rows["error_percent"] / 100)]


def _counts(scene, error):
    return (abs(error) > FLOOR) & ~np.isin(scene, NEUTRAL)


def _law(name, rows):
    knob, sound = methods.all_methods()[name].resolution.knob, _errors(rows)
    terms = np.array([shipped.error_terms(knob, measured(s), v) for s, v in _places(sound)])
    error, spread = _fit(terms, np.log(sound["error_percent"].abs() / 100), "error")
    sizes = np.array([shipped.size_terms(knob, measured(s), v) for s, v in _places(rows)])
    numbers = rows["unknowns"].to_numpy(dtype=float)
    parts = _parts(sizes, numbers)
    # With the unknowns of the law: those are what is known beforehand.
    made = np.maximum(sizes @ parts, 1.0)
    terms = np.array([shipped.cost_terms(measured(s), n) for s, n in zip(rows["scene"], made, strict=True)])
    cost, cost_spread = _fit(terms, np.log(rows["cpu_s"].to_numpy(dtype=float)), "cost")
    each, each_spread = _memory(rows, made)
    unit = methods.EDGE if methods.all_methods()[name].resolution.metric else 1.0
    ends = sorted((rows["value"].min() / unit, rows["value"].max() / unit), reverse=unit != 1.0)
    return shipped.Law(
        name, knob, *ends, np.exp(error[0]), *error[1:], spread, *parts, np.exp(cost[0]), *cost[1:], cost_spread,
        each, each_spread, len(rows), rows["scene"].nunique(),
    )  # fmt: skip


def _places(rows):
    return zip(rows["scene"], rows["value"], strict=True)


def _fit(terms, logs, what):
    """Powers of the terms, and the factor within which nine of ten values are."""
    from scipy.optimize import least_squares

    logs, start, pull = np.asarray(logs, dtype=float), np.array(START[what]), np.array(PULL[what])

    def residuals(powers):
        return np.concatenate([terms @ powers - logs, pull * (powers - start)])

    found = least_squares(residuals, start, loss="soft_l1", x_scale="jac").x
    return found, within(np.exp(terms @ found - logs))


def within(ratios, share=SHARE):
    """Factor, 1 or more, within which a share of ratios is."""
    return float(np.exp(np.quantile(np.abs(np.log(ratios)), share)))


def _parts(sizes, numbers):
    """Non-negative weights of volume, surface and number of inclusions in the unknowns, by relative deviations."""
    from scipy.optimize import nnls

    return nnls(sizes / numbers[:, None], np.ones(len(numbers)))[0]


def _memory(rows, made):
    """Bytes for each unknown, the middle one of the larger rows, and the factor within which nine of ten are."""
    bytes_each = rows["peak_mib"].to_numpy(dtype=float) * 2**20 / made
    large = (made >= MANY) & (bytes_each > 0)
    some = bytes_each[large] if large.any() else np.maximum(bytes_each, 1.0)
    middle = float(np.median(some))
    return middle, within(some / middle)


def left_out(df):
    """Each scene's rows by laws fitted to the other scenes: ratios of what was predicted to what was found."""
    import pandas as pd

    rows, found = usable(df), []
    for scene in rows["scene"].unique():
        others = fitted(rows[rows["scene"] != scene])
        for row in rows[(rows["scene"] == scene) & rows["name"].isin(list(others))].to_dict("records"):
            guess = shipped.predicted_by(others[row["name"]], measured(scene), row["value"])
            error = abs(row["error_percent"]) / 100
            found.append(
                {
                    "scene": scene,
                    "name": row["name"],
                    "error": guess.error / error if _counts(scene, error) else np.nan,
                    "cpu_s": guess.cpu_s / row["cpu_s"],
                    "bytes": guess.bytes / max(row["peak_mib"] * 2**20, 1.0),
                }
            )
    return pd.DataFrame(found, columns=["scene", "name", "error", "cpu_s", "bytes"])


def written(found):
    """Laws as the text of a file."""
    lines = [",".join(shipped.Law._fields)]
    for law in found.values():
        lines.append(",".join(_word(value) for value in law))
    return "\n".join(lines) + "\n"


def _word(value):
    return format(value, DIGITS) if isinstance(value, float) else str(value)


def ship(csv_path, file=shipped.FILE):
    """Fit the laws to stored rows and write the file that the package ships; returns its path."""
    from demheat.runtime.paths import replaced

    with replaced(file) as temporary:
        temporary.write_text(written(fitted(stored(csv_path))), encoding="utf-8")
    return Path(file)


if __name__ == "__main__":
    print(ship(sys.argv[1] if len(sys.argv) > 1 else Path("results") / "speed_error.csv"))
