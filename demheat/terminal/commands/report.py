"""`demheat report`: one page of HTML that needs nothing else, about a scene and what methods answer."""

import sys
import time

from demheat.runtime.deadline import budget
from demheat.runtime.paths import check_target, replaced
from demheat.terminal import pictures
from demheat.terminal.commands.answers import Answer, answered
from demheat.terminal.commands.bounds import bounds_of
from demheat.terminal.commands.compare import usual
from demheat.terminal.commands.knobs import asked
from demheat.terminal.commands.words import assumed, scene_line, spread, time_was_over, typed
from demheat.terminal.report import Content, kinds_of, page, values_of

HEAD = ("method", "W/(m K)", "expected from", "to", "by", "wall s", "CPU s", "unknowns")


def run(file, options) -> int:
    """Solve and write the page; the exit status."""
    path = typed("--out", options.out or f"{file.path.stem}.html", check_target)
    wanted = asked(file, options.methods, options.knob, default=usual())
    found, begun = [], time.monotonic()
    for each in wanted:
        print(f"{each.title} ...", file=sys.stderr, flush=True)
        with budget(options.seconds, begun=begun):
            found.append((each, answered(file.scene, each)))
            _let_go(found)
    with replaced(path) as part:
        part.write_text(page(_content(file, found)), encoding="utf-8")
    print(f"page {path}")
    if said := time_was_over(options.seconds, [each for each, answer in found if answer.cut], file.scene):
        print(f"demheat: {said}", file=sys.stderr)
    return 1 if any(answer.status in ("failed", "invalid", "stopped") for _, answer in found) else 0


def _let_go(found):
    """Keep the field of the answer that is narrowest: one is drawn, all would fill the memory."""
    held = [place for place, (_, answer) in enumerate(found) if answer.field is not None]
    best = min(held, key=lambda place: _rank(*found[place]), default=None)
    for place in held:
        if place != best:
            found[place] = found[place][0], found[place][1]._replace(field=None)


def _rank(each, answer: Answer):
    """Witnesses last, as their fields are dear; then by the interval, none last."""
    width = answer.upper - answer.lower
    return each.method.role == "witness", not width >= 0, width


def _content(file, found):
    scene, bounds = file.scene, bounds_of(file.scene)
    good = [(each, answer) for each, answer in found if answer.status == "ok"]
    drawn, field = next(((each.title, answer.field) for each, answer in good if answer.field is not None), ("", None))
    told = [f"{each.method.name} {answer.status}: {note}" for each, answer in found for note in answer.notes]
    return Content(
        title=f"{file.path.stem}: conduction of heat",
        line=scene_line(scene),
        source=file.path.read_text(encoding="utf-8-sig"),
        kinds=kinds_of(scene),
        size=scene.size,
        values=(drawn, [] if field is None else values_of(field)),
        figures=_figures(scene, good, bounds, (drawn, field)),
        rows=[HEAD, *(_row(*each) for each in good), *map(_bound, bounds)],
        told=told,
        assumed=assumed(scene),
    )


def _figures(scene, good, bounds, drawn):
    """Pictures by what they show."""
    found, (title, field) = {"scene": scene.plot()}, drawn
    entries = [(each.method.name, *answer[1:4]) for each, answer in good if answer.conductivity == answer.conductivity]
    if entries:
        found["answers"] = pictures.plot_comparison(scene, entries, bounds)
    if field is not None:
        found |= {f"Across {name}, by {title}": field.plot(axis=axis) for axis, name in enumerate("xyz")}
    return found


def _row(each, answer):
    cost = [f"{answer.cost[name]:.2g}" if answer.cost.get(name) is not None else "" for name in ("wall_s", "cpu_s")]
    numbers = spread(answer.conductivity, answer.lower, answer.upper)
    return each.title, *numbers, answer.how, *cost, str(answer.cost.get("unknowns") or "")


def _bound(bound):
    return bound.name, "", f"{bound.lower:.6g}", f"{bound.upper:.6g}", f"certain of {bound.holds}", "", "", ""
