"""`demheat effective`: the conductivity tensor of a body, by the method that gets to an accuracy at least cost."""

import sys
import warnings

import numpy as np

from demheat.cheapest import effective
from demheat.cheapest.ways import knobs_of
from demheat.scene.inputs import one_line
from demheat.terminal.commands.words import aligned, decimals, scene_line


def run(file, options) -> int:
    """Solve and print; the exit status."""
    accuracy = wanted_accuracy(file, options)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = effective(file.scene, accuracy=accuracy, method=options.methods, seconds=options.seconds)
    for each in dict.fromkeys(one_line(each.message) for each in caught if issubclass(each.category, UserWarning)):
        print(f"demheat: warning: {each}", file=sys.stderr)
    print(f"{file.path}: {scene_line(file.scene)}\n")
    print("\n".join(_tensor(found.tensor, (found.upper - found.lower) / 2)))
    by = ", ".join(filter(None, (found.method, knobs_of(found), f"within {100 * found.accuracy:.2g} %")))
    print(f"\nby {by} ({found.how})")
    print(f"cost {found.cost['wall_s']:.2g} s, {found.cost['cpu_s']:.2g} CPU-s")
    for line in (*found.saved, *found.passed):
        print(line)
    return 1 if found.cut else 0


def _tensor(tensor, half):
    """Lines of a tensor: its entries with half of their intervals, then principal values and directions."""
    digits = decimals(2 * float(half.max()))
    lines = [("", "x", "y", "z", "")]
    for name, row, halves in zip("xyz", tensor, half, strict=True):
        lines.append((name, *(f"{k:.{digits}f} +- {h:.1g}" for k, h in zip(row, halves, strict=True)), "W/(m K)"))
    yield aligned(lines)
    values, axes = np.linalg.eigh(tensor)
    yield "\nprincipal values, and their directions"
    for place in (2, 1, 0):
        axis = axes[:, place] * np.sign(axes[np.argmax(np.abs(axes[:, place])), place]) + 0.0
        # Values that may as well be one have no directions of their own.
        alike = np.sum(np.abs(values - values[place]) <= 2 * half.max()) > 1
        along = "no direction of its own" if alike else f"({', '.join(f'{part:.3f}' for part in axis)})"
        yield f"{values[place]:.{digits}f} W/(m K)  {along}"


def wanted_accuracy(file, options) -> float:
    """Accuracy of the command line, else of the file, else a thousandth."""
    return next(each for each in (options.accuracy, file.accuracy, 1e-3) if each is not None)
