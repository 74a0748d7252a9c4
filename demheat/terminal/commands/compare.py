"""`demheat compare`: all methods that take a scene in one table, with intervals, costs and bounds, and in a picture.

Each row is stored as soon as its method is done; the same command goes on where it was stopped.
"""

import math
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np

from demheat.declared import all_methods
from demheat.io.scenes.write import text_of_scene
from demheat.runtime.deadline import OVER, budget
from demheat.runtime.paths import check_output, made_folder, replaced
from demheat.runtime.rows import each_kept
from demheat.scene.inputs import one_line
from demheat.terminal.commands import rows
from demheat.terminal.commands.answers import answered
from demheat.terminal.commands.bounds import bounds_of
from demheat.terminal.commands.knobs import Asked, asked
from demheat.terminal.commands.words import aligned, scene_line, spread, time_was_over, typed
from demheat.terminal.slices import on_plane

OUT = "demheat-out"
# Of a bound: what tolerances of solvers may take a right value beyond it.
ROUNDING = 1e-6
# Pixels along the longer side of the slice in the picture.
PIXELS = 121
# Bytes of the file of such a slice, unpacked: a scene of a hundred thousand spheres is 40 MB of text there.
LARGEST = 2**27


def run(file, options) -> int:
    """Compare, print and store; the exit status."""
    chosen = options.methods or (usual(everything=True) if options.all else None)
    wanted = asked(file, chosen, options.knob, default=usual())
    path = typed("--out", options.out or OUT, check_output) / f"{file.path.stem}.csv"
    print(f"{file.path}: {scene_line(file.scene)}", flush=True)
    how = {"interval": not options.no_interval, "force": options.force, "seconds": options.seconds}
    made = compared(file.scene, wanted, path, **how)
    bounds = bounds_of(file.scene)
    print("\n" + table(made, bounds))
    late = [each for each, row in zip(wanted, made, strict=True) if OVER in row["note"]]
    if said := time_was_over(options.seconds, late, file.scene):
        print(f"{said} Rows that are done stay, and the same command goes on with the others.")
    try:
        drawn = f"picture {picture(file.scene, made, bounds, path)}"
    except ImportError as error:
        drawn = f"no picture: {one_line(error)}"
    print(f"\nrows {path}, {drawn}")
    return 1 if any(row["status"] in ("failed", "invalid", "stopped") for row in made) else 0


def usual(*, everything: bool = False) -> list[str]:
    """Names of the methods that are compared where none is named: the main ones, formulas and witnesses."""
    steady = [method for method in all_methods().values() if method.call != "evolve"]
    return [m.name for m in steady if everything or m.role != "beside" or m.call == "estimate"]


def compared(
    scene, wanted: list[Asked], path: Path, *, interval: bool, force: bool, seconds: float | None = None
) -> list[dict[str, str]]:
    """Rows of methods on a scene, those that are stored and hold as they are; each new one is stored at once.

    What the time did not suffice for is not stored: the same command goes on with it.
    """
    text, known = text_of_scene(scene), rows.read(path)
    how = {"interval": interval, "limit": partial(budget, seconds, begun=time.monotonic())}
    keys = {rows.key_of(each, text, interval=interval): each for each in wanted}
    todo = [key for key in keys if force or key not in known]

    def keep(key, made):
        known[key], whole = made
        if whole:
            rows.add(path, key, known[key])

    made = (_made(scene, keys[key], key, path, **how) for key in todo)
    for _ in each_kept(todo, enumerate(made), keep, what="compare"):
        pass
    return [known[key] for key in keys]


def _made(scene, each, key, path, *, interval, limit):
    """A new row, and whether the time sufficed for all of it; the field is let go before the next is made."""
    print(f"{each.title} ...", file=sys.stderr, flush=True)
    with limit():
        answer = answered(scene, each, interval=interval)
    made_folder(path.parent)
    if answer.field is not None:
        _keep_slice(answer.field, path, text_of_scene(scene), again=each.method.role == "witness")
    return rows.row_of(each, answer, key), not answer.cut


def table(made, bounds) -> str:
    """Rows and bounds as text."""
    lines = [("method", "W/(m K)", "expected from", "to", "wall s", "CPU s", "interval", "unknowns")]
    for row in made:
        if row["status"] == "ok":
            numbers = spread(*(_float(row[name]) for name in ("conductivity", "lower", "upper")))
            costs = [_short(row[name]) for name in ("wall_s", "cpu_s", "interval_cpu_s")]
            lines.append((row["method"], *numbers, *costs, row["unknowns"]))
    for bound in bounds:
        low, high = f"{bound.lower:.6g}", f"{bound.upper:.6g}"
        lines.append((bound.name, "", low, high, "", "", "", f"bounds of {bound.holds}"))
    told = [f"{row['method']} {row['status']}: {row['note']}" for row in made if row["status"] != "ok"]
    answers = [row for row in made if row["status"] == "ok"]
    told += [f"{row['method']}: {row['note']}" for row in answers if row["note"]]
    told += [f"{row['method']}: {words}" for row in answers for words in _outside(_float(row["conductivity"]), bounds)]
    return "\n".join([aligned(lines), "", *told, "Costs include loading and compiling; `interval` in CPU-s."])


def _outside(value, bounds):
    """What is to be said of a value that no such body can have; a method in doubt is the value's, not the bound's."""
    for bound in bounds:
        room = ROUNDING * (bound.upper if math.isfinite(bound.upper) else value)
        if bound.certain and not bound.lower - room <= value <= bound.upper + room:
            side, limit = ("below", bound.lower) if value < bound.lower else ("above", bound.upper)
            yield f"{value:.6g} is {side} {limit:.6g}, which is certain ({bound.name}): its error is no less than that"


def picture(scene, made, bounds, path: Path) -> Path:
    """Draw the rows and a slice beside them; where it is."""
    from demheat.terminal import pictures

    good = [row for row in made if row["status"] == "ok" and row["conductivity"]]
    entries = [(row["method"], *(_float(row[name]) for name in ("conductivity", "lower", "upper"))) for row in good]
    say = partial(print, file=sys.stderr)
    figure = pictures.plot_comparison(scene, entries, bounds, _slice(path, text_of_scene(scene), say))
    drawn = path.with_suffix(".png")
    with replaced(drawn) as part:
        figure.savefig(part, dpi=120)
    return drawn


def _keep_slice(field, path, text, *, again):
    """Temperatures over the middle plane, for the picture; a witness goes before others, all before a broken file."""
    from demheat.terminal.pictures import across_of

    if again or _slice(path, text) is None:
        axis = across_of(field.scene)
        temperature = on_plane(field, axis=axis, at=field.scene.size[axis] / 2, n=PIXELS).temperature
        with replaced(_slice_file(path)) as part:
            np.savez(part, temperature=temperature, scene=text)


def _slice_file(path):
    return path.with_suffix(".slice.npz")


def _slice(path, text, say=lambda line: None):
    """What is kept of this very scene, or None; of a file that is none of ours a line is said."""
    try:
        with _slice_file(path).open("rb") as stream, np.load(stream) as kept:
            if sum(each.file_size for each in kept.zip.infolist()) > LARGEST:
                raise ValueError(f"its arrays take more than {LARGEST} bytes")
            temperature = kept["temperature"] if str(kept["scene"]) == text else None
            if temperature is not None and (temperature.ndim != 2 or temperature.dtype != float):
                raise ValueError("its temperatures are no plane of numbers")
            return temperature
    except FileNotFoundError:
        return None
    except Exception as error:  # noqa: BLE001 - of a file cut short, what NumPy and its decoders happen to raise
        say(f"{_slice_file(path)}: no slice, or a part of one: {one_line(error)}; drawn without until a row is made")
        return None


def _float(text):
    return float(text or "nan")


def _short(text):
    return f"{float(text):.2g}" if text else ""
