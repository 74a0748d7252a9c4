"""The conductivity tensor to an accuracy, by the method that gets there at least cost."""

import math
import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from demheat.cheapest.answers import answer, certain, excess
from demheat.cheapest.loads import loads_of
from demheat.cheapest.ways import HOMES, Way, finer, knobs_of, shorter, ways
from demheat.runtime.deadline import budget, look
from demheat.runtime.limits import free_memory
from demheat.runtime.process_state import cpu_seconds
from demheat.scene import Scene
from demheat.scene.frozen import read_only
from demheat.scene.inputs import chosen, finite, one_line

# Of the memory that is free.
SHARE = 0.8
# A way that was begun is left where another should cost less than one in so many parts: what the laws tell is about
# twice off, and what it begins with is paid once more.
LEAVE = 2.0


@dataclass(frozen=True)
class Effective:
    """Conductivity tensor of a body, each entry with its interval.

    Attributes
    ----------
    tensor, lower, upper : (3, 3) float array, W/(m K)
        Symmetric. What each entry is, and between which values it is expected; of method "bracket" it is certain.
    method : str
    knobs : mapping
        With which the method got there.
    cost : mapping
        `cpu_s`, `wall_s`, and `rounds` of refinement.
    how : str
        How the interval was found.
    saved : tuple of str
        What symmetry saved.
    passed : tuple of str
        Methods that were tried before, and why they did not do, or were left for one that should cost less.
    cut : str
        Where the time was over before the intervals were as narrow as they were asked for; else empty.

    Examples
    --------
    >>> from demheat import effective, gallery
    >>> found = effective(gallery.sphere_in_cube(5.0))
    >>> bool((found.lower <= found.tensor).all()), found.accuracy < 1e-3
    (True, True)
    """

    tensor: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    method: str
    knobs: Mapping
    cost: Mapping
    how: str
    saved: tuple[str, ...] = ()
    passed: tuple[str, ...] = field(default=(), repr=False)
    cut: str = ""

    @property
    def accuracy(self) -> float:
        """Half of the widest interval over the mean of the diagonal; 0 where nothing conducts."""
        scale = float(np.trace(self.tensor)) / 3
        return float(np.max(self.upper - self.lower)) / 2 / scale if scale > 0 else 0.0


class Recommendation(NamedTuple):
    """What `effective` would do.

    Attributes
    ----------
    method : str
        Empty if nothing gets there.
    knobs : mapping
    cpu_s : float, s
        That are to be expected; NaN if unknown.
    bytes : float
    why : str
        In words, a line for each way.
    ways : tuple of Way

    Examples
    --------
    >>> from demheat import gallery, recommend
    >>> told = recommend(gallery.sphere_in_cube(5.0))
    >>> told.method, told.why.splitlines()[0]
    ('exact', '1 of 3 loads: axes alike')
    """

    method: str
    knobs: Mapping
    cpu_s: float
    bytes: float
    why: str
    ways: tuple[Way, ...]


def effective(
    scene: Scene,
    *,
    accuracy: float = 1e-3,
    method: str | Sequence[str] | None = None,
    memory: float | None = None,
    seconds: float | None = None,
) -> Effective:
    """The effective conductivity tensor of a body to an accuracy, as cheaply as is known here.

    Laws of error and cost (study `frontier`) say which method to begin with and how fine; the interval of each
    answer (`Field.error`, study `estimates`) says whether to refine it, or to begin with another method, if that should
    cost less than half. Mirror planes cut the body, alike axes share a load, loads on one body share its set-up.

    Parameters
    ----------
    scene : Scene
        A periodic cell, or a box between two isothermal walls with four insulated faces; its own load does not matter.
    accuracy : float
        Half of each entry's interval, over the entry on the diagonal and over the mean of the diagonal beside it.
    method : {"exact", "multipole", "fem", "fft", "dem", "bracket"} or sequence of them, optional
        Only these. "bracket" gives certain bounds, and is taken only if it is named.
    memory : float, bytes, optional
        That may be used. Default: four fifths of what is free.
    seconds : float, s, optional
        That it may take, see `demheat.budget`. Where they are over, the narrowest answer that is done is returned, with
        its interval and a warning; its `accuracy` is then larger than what was asked for.

    Returns
    -------
    Effective

    Raises
    ------
    ValueError
        If an argument is not as described, or the load does not fix a steady temperature.
    NotImplementedError
        If the load is another.
    RuntimeError
        If no method gets there in the memory, with what each lacks.
    TimeoutError
        If the seconds are over before there is any answer.

    Warns
    -----
    UserWarning
        If the seconds are over before there is an answer as narrow as it was asked for.

    Examples
    --------
    >>> from demheat import effective, gallery
    >>> found = effective(gallery.sphere_in_cube(5.0), accuracy=1e-4)
    >>> found.method, found.tensor.diagonal().round(4)
    ('exact', array([42.6403, 42.6403, 42.6403]))
    """
    accuracy, memory = _checked(accuracy, memory)
    allowed = _allowed(method)
    clock, cpu = time.perf_counter(), cpu_seconds()
    loads = loads_of(scene)
    with budget(seconds):
        found, way, passed, cut = _found(loads, accuracy, allowed, memory)
    cost = {"cpu_s": cpu_seconds() - cpu, "wall_s": time.perf_counter() - clock, "rounds": way.rounds + 1}
    arrays = map(read_only, (found.tensor, found.tensor - found.half, found.tensor + found.half))
    return Effective(*arrays, way.method, dict(way.knobs), cost, found.how, loads.saved, passed, cut)


def _found(loads, accuracy, allowed, memory):
    """Answer, way, ways that did not do, where time was over; of all ways the one that should cost least goes on."""
    left = [way for way in ways(loads, accuracy, memory) if way.method in allowed]
    passed, best, begun, missing = [], (math.inf, None, None), None, math.inf
    while left:
        way = _next(left, begun)
        left.remove(way)
        if begun in left:
            passed.append(_left(begun, missing, way))
        if not way.refused:
            try:
                look(way.method)
                found = answer(way, loads)
                missing = excess(found, accuracy)
                best = min(best, (missing, found, way), key=lambda each: each[0])
                if missing <= 1:
                    return found, way, tuple(passed), ""
                way = begun = finer(way, loads, missing, memory)
            except TimeoutError as error:
                return _so_far(best, accuracy, f"{way.method}: {one_line(error)}", passed)
            except (NotImplementedError, MemoryError, ImportError) as error:
                way = way._replace(refused=one_line(error))
            except (RuntimeError, ValueError) as error:
                # Elements may be too long for the body.
                way = shorter(way, loads, memory, one_line(error))
                if not way.refused:
                    passed.append(f"{way.method}: {one_line(error)}; begins anew with {knobs_of(way)}")
        if way.refused:
            passed.append(f"{way.method}: {way.refused}")
        else:
            left.append(way)
    if "bracket" in allowed:
        try:
            found, knobs = certain(loads, accuracy)
        except TimeoutError as error:
            return _so_far(best, accuracy, f"bracket: {one_line(error)}", passed)
        return found, Way("bracket", knobs), tuple(passed), ""
    missing, found, way = best
    if found is not None:
        passed.append(f"nearest is {way.method}, within {missing * accuracy:.2g}")
    raise RuntimeError(f"effective: no method gets to accuracy = {accuracy:g} here. " + "; ".join(passed))


def _next(left, begun):
    """The way that should cost least, or the one that was begun, unless that should cost much more."""
    best = min(left, key=lambda each: each.rank)
    stays = begun in left and begun.rank[:3] == best.rank[:3] and begun.cpu_s < LEAVE * best.cpu_s
    return begun if stays else best


def _left(begun, missing, other):
    """Why a way that was begun is not gone on with: another should cost less."""
    return (
        f"{begun.method}: half of its interval is {missing:.2g} times what is allowed; "
        f"{knobs_of(begun)} should cost {begun.cpu_s:.2g} CPU-s, {other.method} {other.cpu_s:.2g}"
    )


def _so_far(best, accuracy, why, passed):
    """The narrowest answer when the time is over."""
    missing, found, way = best
    if found is None:
        raise TimeoutError(f"effective: {why}; no answer is done by then: must be more, or a larger accuracy")
    warnings.warn(f"effective: {why}; accuracy is {missing * accuracy:.2g} only", stacklevel=4)
    return found, way, tuple(passed), why


def recommend(scene: Scene, accuracy: float = 1e-3, *, memory: float | None = None) -> Recommendation:
    """What `effective` would do for a scene, what it would cost, and why; nothing but closed forms is solved.

    Parameters
    ----------
    scene, accuracy, memory
        As those of `effective`, which says what is raised.

    Returns
    -------
    Recommendation

    Examples
    --------
    >>> from demheat import gallery, recommend
    >>> recommend(gallery.laminate()).method
    'exact'
    """
    accuracy, memory = _checked(accuracy, memory)
    loads = loads_of(scene)
    found = tuple(ways(loads, accuracy, memory))
    lines = [*loads.saved, *map(_said, found)]
    best = found[0] if not found[0].refused and not found[0].doubt else Way("", {})
    return Recommendation(best.method, best.knobs, best.cpu_s, best.bytes, "\n".join(lines), found)


def _checked(accuracy, memory):
    accuracy = finite("accuracy", accuracy, "a number from 1e-9 to below 1, as 0.01 for 1 %", lambda v: 1e-9 <= v < 1)
    if memory is None:
        return accuracy, SHARE * free_memory()
    return accuracy, finite("memory", memory, "a number of bytes > 0", lambda v: v > 0)


def _allowed(method):
    """Names of methods."""
    if method is None:
        return tuple(name for name in HOMES if name != "bracket")
    names = tuple(method) if isinstance(method, (list, tuple)) else (method,)
    if not names:
        raise ValueError(f"method = {method!r}: must name one at least, or be None for any")
    for name in names:
        chosen("method", name, tuple(HOMES))
    return names


def _said(way):
    if way.refused or way.doubt:
        return f"{way.method}: {f'no, {way.refused}' if way.refused else f'in doubt, {way.doubt}'}"
    cost = "cost unknown" if math.isnan(way.cpu_s) else f"about {way.cpu_s:.2g} CPU-s, {way.bytes / 2**20:.2g} MiB"
    return f"{way.method}: {cost}{f', beginning with {knobs_of(way)}' if way.knobs else ''}"
