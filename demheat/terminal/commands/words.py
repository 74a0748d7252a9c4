"""Scenes and answers in words, for terminals and pictures."""

import math
from collections import Counter
from pathlib import Path

LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "um"), (1e-9, "nm"))


def typed(option: str, value, check):
    """What a check of a path makes of an option; its error names the option as it was typed."""
    try:
        return check(value)
    except ValueError as error:
        raise ValueError(f"{option} {value}: {str(error).removeprefix(f'path = {str(Path(value))!r}: ')}") from None


def time_was_over(seconds: float | None, late, scene) -> str:
    """What to do where the time was over before some methods were done; empty if all were."""
    if not late or seconds is None:
        return ""
    coarser = next(filter(None, (each.coarser(scene) for each in late)), "")
    sizes = f", or a coarser size, as {coarser}" if coarser else ""
    names = ", ".join(each.method.name for each in late)
    return f"The time was over before {names} got done: must be more, as --seconds {4 * seconds:g}{sizes}."


def scene_line(scene) -> str:
    """A scene in one line."""
    factor, unit = next((each for each in LENGTHS if max(scene.size) >= each[0]), LENGTHS[-1])
    sides = " x ".join(f"{side / factor:.6g}" for side in scene.size)
    kinds = Counter(shape.kind for shape in scene.inclusions)
    told = "no inclusions" if scene.image is None else f"image of {' x '.join(map(str, scene.image.shape))} voxels"
    inside = ", ".join(f"{count} {kind}{'s' if count > 1 else ''}" for kind, count in kinds.items()) or told
    spread = sorted(set(scene.mean_conductivities.tolist()))
    k = f"{spread[0]:.4g}" + (f" to {spread[-1]:.4g}" if len(spread) > 1 else "")
    load = "periodic cell" if scene.periodic else "walls " + (", ".join(scene.walls) or "insulated")
    return f"{scene.domain} of {sides} {unit}, {inside}, {k} W/(m K), {load}"


def assumed(scene) -> list[str]:
    """What any method takes for granted of a scene, in sentences."""
    k = scene.mean_conductivities
    found = ["Steady conduction by Fourier's law: no radiation or convection within the body."]
    if scene.periodic:
        found.append("The box is repeated all round, under a mean gradient of the temperature: edges have no effect.")
    elif len(scene.walls) < 6:
        found.append(f"Faces other than {', '.join(scene.walls)} are insulated, as mirrors.")
    if scene.image is not None:
        found.append(
            "Each voxel is wholly of its label: stairs for smooth surfaces are an error that no interval holds."
        )
    elif scene.inclusions and not scene.resistances.any():
        found.append("Surfaces between materials let heat pass without a resistance.")
    if not scene.varies:
        found.append("Conductivities do not depend on the temperature.")
    if not scene.anisotropic:
        found.append("Materials conduct alike in all directions.")
    if k.min() == 0:
        found.append("Pores conduct nothing.")
    return [*found, "An interval is what a method expects of its own error; it knows nothing of errors of the scene."]


def interval(found) -> str:
    """Conductivity of an answer with its interval, with as many digits as that tells."""
    if math.isnan(found.conductivity):
        return "none, as the load is not one pair of walls with two temperatures"
    if not found.upper >= found.lower:
        return f"{found.conductivity:.6g} W/(m K)"
    k, low, high = spread(found.conductivity, found.lower, found.upper)
    return f"{k} W/(m K), expected from {low} to {high} ({found.how})"


def decimals(width: float) -> int:
    """Decimals that show two digits of a width."""
    return 6 if width <= 0 else min(max(1 - math.floor(math.log10(width)), 0), 12)


def costs(found) -> str:
    """What an answer cost."""
    cost = found.cost
    words = [f"{cost['wall_s']:.2g} s", f"{cost['cpu_s']:.2g} CPU-s"]
    if cost.get("interval_cpu_s") is not None:
        words.append(f"{cost['interval_cpu_s']:.2g} CPU-s for the interval")
    if cost.get("unknowns"):
        words.append(f"{cost['unknowns']} unknowns")
    return ", ".join(words)


def spread(conductivity: float, lower: float, upper: float) -> tuple[str, str, str]:
    """A conductivity and the ends of its interval with as many digits as that tells; empty where there is none."""
    if math.isnan(conductivity):
        return "", "", ""
    if not upper >= lower:
        return f"{conductivity:.6g}", "", ""
    digits = decimals(upper - lower)
    return tuple(f"{value:.{digits}f}" for value in (conductivity, lower, upper))


def aligned(lines) -> str:
    """Rows of words as columns: the first to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*(line[:-1] for line in lines), strict=True)]
    rows = []
    for first, *middle, last in lines:
        cells = [first.ljust(widths[0]), *(word.rjust(width) for word, width in zip(middle, widths[1:], strict=True))]
        rows.append("  ".join([*cells, last]).rstrip())
    return "\n".join(rows)
