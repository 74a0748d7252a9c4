"""`demheat effective`: the conductivity tensor of a body, by the method that gets to an accuracy at least cost."""

from __future__ import annotations

import sys
import warnings

from demheat.cheapest import effective
from demheat.cheapest.ways import knobs_of
from demheat.scene.inputs import one_line
from demheat.terminal.commands.words import decimals, names, scene_line


def run(file, options) -> int:
    """Solve and print; the exit status."""
    accuracy = wanted_accuracy(file, options)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = effective(file.scene, accuracy=accuracy, method=names(options.methods), seconds=options.seconds)
    for each in dict.fromkeys(one_line(each.message) for each in caught if issubclass(each.category, UserWarning)):
        print(f"demheat: warning: {each}", file=sys.stderr)
    print(f"{file.path}: {scene_line(file.scene)}\n")
    widths = found.upper - found.lower
    for row, width in zip(found.tensor, widths, strict=True):
        digits = decimals(float(widths.max()))
        print("  ".join(f"{k:.{digits}f} +- {w / 2:.1g}" for k, w in zip(row, width, strict=True)), " W/(m K)")
    by = ", ".join(filter(None, (found.method, knobs_of(found), f"accuracy {found.accuracy:.2g}")))
    print(f"\nby {by} ({found.how})")
    print(f"cost {found.cost['wall_s']:.2g} s, {found.cost['cpu_s']:.2g} CPU-s")
    for line in (*found.saved, *found.passed):
        print(line)
    return 1 if found.cut else 0


def wanted_accuracy(file, options) -> float:
    """Accuracy of the command line, else of the file, else a thousandth."""
    return next(each for each in (options.accuracy, file.accuracy, 1e-3) if each is not None)
