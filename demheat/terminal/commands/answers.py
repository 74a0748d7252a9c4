"""One method on one scene: its conductivity with an interval, what that cost, or why there is none."""

import math
import warnings
from typing import NamedTuple

from demheat.declared import load
from demheat.field import Field
from demheat.runtime.deadline import look
from demheat.runtime.process_state import stopwatch
from demheat.scene.inputs import one_line
from demheat.terminal.commands.knobs import Asked


class Answer(NamedTuple):
    """What became of one method."""

    # {"ok", "refused", "invalid", "failed", "stopped"}: The method's answer; what it cannot do; a knob or a scene that
    # makes no sense; what went wrong; that the time was over
    status: str
    # conductivity, lower, upper: W/(m K): NaN where there is none
    conductivity: float = math.nan
    lower: float = math.nan
    upper: float = math.nan
    how: str = ""  # How the interval was found
    cost: dict = {}  # `wall_s`, `cpu_s` of the solve, loading and compiling included, and `interval_cpu_s`
    notes: tuple = ()  # list of str: Why there is no answer, and warnings
    cut: bool = False  # Whether the time was over, before the answer or before its interval
    field: Field | None = None  # Field or None


def answered(scene, asked: Asked, *, interval: bool = True) -> Answer:
    """Run one method on a scene."""
    method = asked.method
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            look("other methods")
            found = _run(scene, method, asked.knobs, interval)
        except TimeoutError as error:
            found = Answer("stopped", notes=(one_line(error),), cut=True)
        except NotImplementedError as error:
            found = Answer("refused", notes=(one_line(error),))
        except ValueError as error:
            found = Answer("invalid", notes=(one_line(error),))
        except (RuntimeError, MemoryError, ImportError, OSError) as error:
            found = Answer("failed", notes=(one_line(error),))
        except Exception as error:  # noqa: BLE001 - a slip in one method must not cost the answers of others
            found = Answer("failed", notes=(f"{type(error).__name__}: {one_line(error)}",))
    told = dict.fromkeys(one_line(each.message) for each in caught if issubclass(each.category, UserWarning))
    return found._replace(notes=(*found.notes, *(f"warning: {each}" for each in told)))


def _run(scene, method, knobs, interval):
    module, knobs = load(method.module), {**method.knobs, **knobs}
    if method.call == "evolve":
        raise NotImplementedError(f"{method.name} solves in time, and this command a steady state")
    spent = stopwatch()
    if method.call == "estimate":
        return Answer("ok", module.estimate(scene, **knobs), how="a formula", cost=spent())
    field = module.solve(scene, **knobs)
    conductivity = conductivity_of(field)
    cost = spent() | {name: field.stats.get(name) for name in ("unknowns", "iterations")}
    found = Answer("ok", conductivity, cost=cost, field=field)
    return _with_interval(found, field) if interval else found


def _with_interval(found, field):
    spent = stopwatch()
    try:
        error = field.error
    except (NotImplementedError, RuntimeError, TimeoutError) as reason:
        note = f"no interval: {one_line(reason).removeprefix('Field.error: ')}"
        return found._replace(notes=(note,), cut=isinstance(reason, TimeoutError))
    cost = found.cost | {"interval_cpu_s": spent()["cpu_s"]}
    return found._replace(lower=error.lower, upper=error.upper, how=error.how, cost=cost)


def conductivity_of(field) -> float:
    """Effective conductivity of a field, W/(m K); NaN where its load defines none."""
    try:
        return field.conductivity
    except ValueError:
        return math.nan
