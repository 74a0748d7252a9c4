"""Which methods a command is to run, and with which knobs: from the file's [solve] and from the command line."""

import inspect
import re
from typing import NamedTuple

from demheat.declared import all_methods, load
from demheat.io.scenes.units import LENGTH, read_quantity
from demheat.io.words import nearest
from demheat.method import Method

# Keywords that no text can give.
OBJECTS = {"packing"}
WORDS = {"true": True, "false": False, "none": None}


class Asked(NamedTuple):
    """One method with the knobs that are asked for."""

    method: Method
    knobs: dict

    @property
    def title(self) -> str:
        """Its name and knobs in words."""
        return " ".join([self.method.name, *(f"{name}={value}" for name, value in self.knobs.items())])

    def coarser(self, scene) -> str:
        """The option with which it costs less: half of the resolution, or the coarse one; empty if it has none."""
        refined = self.method.resolution
        if refined is None:
            return ""
        value = self.knobs.get(refined.knob)
        if isinstance(value, int | float):
            value = 2 * value if refined.metric else max(int(value) // 2, 1)
        else:
            value = self.method.at(self.method.coarse, max(scene.size))[refined.knob]
        return f"--knob {self.method.name}.{refined.knob}={value:.4g}"


def asked(file, names, words, *, default) -> list[Asked]:
    """Methods with their knobs."""
    chosen = list(names or file.methods or default)
    knobs = {name: dict(file.methods.get(name, {})) for name in chosen}
    for name, own in knobs.items():
        for knob in own:
            _check(
                all_methods()[name], knob, lambda what, at=(name, knob): file.source.error(("solve", *at), f": {what}")
            )
    for word in words:
        _add(knobs, word)
    return [Asked(all_methods()[name], knobs[name]) for name in chosen]


def known(method: Method) -> dict[str, object] | None:
    """Keywords of a method that are free, what it fixes is not, with their defaults; None where it is not installed."""
    try:
        function = getattr(load(method.module), method.call)
    except ImportError:
        # Its run says what it lacks, and costs no other method its own.
        return None
    free = [each for each in inspect.signature(function).parameters.values() if each.kind is each.KEYWORD_ONLY]
    return {each.name: each.default for each in free if each.name not in {*OBJECTS, *method.knobs}}


def _add(knobs, word):
    """Put a knob of the command line where it belongs."""
    left, equal, text = word.partition("=")
    *names, knob = left.rsplit(".", 1)
    if not equal or not knob:
        raise ValueError(f"--knob {word}: must be like voxels=64 or fft.voxels=64")
    if names and names[0] not in knobs:
        raise ValueError(f"--knob {word}: no method {names[0]!r} is asked for{nearest(names[0], knobs)}")
    takers = names or [name for name in knobs if knob in (known(all_methods()[name]) or ())]
    # What fixes it says so.
    takers = takers or [name for name in knobs if knob in all_methods()[name].knobs]
    if not takers:
        everything = set().union(*(known(all_methods()[name]) or () for name in knobs))
        near = nearest(knob, everything) or f"; must be one of {', '.join(sorted(everything)) or 'none'}"
        raise ValueError(f"--knob {word}: no knob of {', '.join(knobs)}{near}")
    for name in takers:
        _check(all_methods()[name], knob, lambda what: ValueError(f"--knob {word}: {what}"))
        knobs[name][knob] = _value(all_methods()[name], knob, text, word)


def _check(method, knob, error):
    """Raise what `error` makes of the reason unless a method has a knob."""
    if knob in method.knobs:
        raise error(f"method {method.name!r} is what has {knob} = {method.knobs[knob]!r}; must be left out")
    names = known(method)
    if names is not None and knob not in names:
        near = nearest(knob, names) or f"; must be one of {', '.join(sorted(names)) or 'none'}"
        raise error(f"no knob of {method.name}{near}")


def _power(text):
    """A whole number with a power of ten, as 1e5."""
    if not re.fullmatch(r"[+-]?\d+[eE]\+?\d{1,2}", text, re.ASCII):
        raise ValueError
    return int(float(text))


def _value(method, knob, text, word):
    """What a text means: a number, a flag, a length with its unit, or itself."""
    for kind in (int, _power, float):
        try:
            return kind(text)
        except ValueError:
            pass
    if method.resolution is not None and method.resolution.metric and knob == method.resolution.knob:
        try:
            return read_quantity(text, LENGTH)[0]
        except ValueError as error:
            raise ValueError(f"--knob {word}: {error}") from None
    return WORDS.get(text.lower(), text)
