"""What `--help` says besides options: examples, methods and their knobs, units, formats, each from where it stands."""

from textwrap import fill

from demheat.declared import all_methods
from demheat.io.fields import WRITERS
from demheat.io.images import READERS
from demheat.io.packings import SUFFIXES
from demheat.io.scenes import units
from demheat.io.scenes.spheres import TABLES
from demheat.io.scenes.units import Quantity
from demheat.io.surfaces import READ
from demheat.runtime.extras import lacking
from demheat.terminal.commands.knobs import known

# Each works in an empty folder, but the last in a clone.
EXAMPLES = {
    "init": "demheat init",
    "solve": "demheat init && demheat solve scene.toml --methods fft,exact --knob fft.voxels=32",
    "compare": "demheat init && demheat compare scene.toml --methods fft,exact,maxwell",
    "effective": "demheat init && demheat effective scene.toml --accuracy 1e-2",
    "recommend": "demheat init && demheat recommend scene.toml --accuracy 1e-4",
    "view": "demheat init && demheat view scene.toml --method fft",
    "report": "demheat init && demheat report scene.toml --methods fft,exact",
    # Answers are of a program of one's own; a clone has those of some.
    "judge": "demheat judge benchmark/answers/fipy.json benchmark/answers/puma.json",
}
WITH_KNOBS = ("solve", "compare", "view", "report")


def told(command: str) -> str:
    """What stands below the options of a command; of none, below the commands."""
    if not command:
        return "\n\n".join([_methods(), _units(), _formats(), _listed("examples", list(EXAMPLES.items()))])
    parts = [f"example:\n  {EXAMPLES[command]}"]
    if command in WITH_KNOBS:
        parts.append("\n".join(["knobs of methods:", *_all_knobs()]))
    return "\n\n".join(parts)


def _methods():
    return _listed("methods", [(name, method.label) for name, method in all_methods().items()])


def _all_knobs():
    """Lines of knobs, once for all methods that have the same."""
    alike = {}
    for name, method in all_methods().items():
        alike.setdefault(_knobs(method), []).append(name)
    for knobs, names in alike.items():
        yield f"  {', '.join(names)}"
        yield fill(knobs, 100, initial_indent="      ", subsequent_indent="      ")


def _knobs(method):
    """Keywords of a method that are free, with their defaults."""
    free = known(method)
    if free is None:
        return f"not installed: {lacking(method.module) or 'it says why when it is asked to solve'}"
    return ", ".join(f"{name}={default}" for name, default in free.items()) or "none"


def _units():
    """Quantities: their SI unit, and ends of keys."""
    named = {name: each for name, each in vars(units).items() if isinstance(each, Quantity) and each.unit}
    lines = [
        (name.lower().replace("_", " "), f"{each.unit}; {', '.join(each.suffixes)}") for name, each in named.items()
    ]
    return _listed('units, in text as "3 mm", or at the end of a key as radius_mm; else SI', lines)


def _formats():
    packings = [suffix for each in SUFFIXES.values() for suffix in each]
    lines = (
        ("spheres", f"{' '.join([*TABLES, *packings])}, [[inclusions]] file = ..."),
        ("bodies", f'{" ".join(READ)}, [[inclusions]] shape = "surface mesh", file = ...'),
        ("images", f"{' '.join(READERS)}, [image] file = ..."),
        ("fields", f"{' '.join(WRITERS)}, solve --write"),
    )
    return _listed("formats", lines)


def _listed(head, lines):
    width = max(len(first) for first, _ in lines)
    return "\n".join([f"{head}:", *(f"  {first.ljust(width)}  {rest}" for first, rest in lines)])
