"""The page of what programs answered: one HTML file, without script, font or picture from elsewhere."""

from collections.abc import Sequence
from html import escape

from demheat.io.answers import Answers
from demheat.terminal.commands.scores import Score, cheapest, short, standings

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1b1b1b; margin: 0 auto; max-width: 72rem; padding: 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; margin-top: 2rem; }
.scroll { overflow-x: auto; margin: .8rem 0; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
th { background: #f3f3f3; } .number { text-align: right; white-space: nowrap; }
.bad { color: #a40e26; font-weight: 600; } .note { color: #555; }
"""


def page(files: Sequence[Answers], scores: Sequence[Score], accuracy: float) -> str:
    """All of it: a leaderboard of several programs, who is cheapest on each scene, every answer of each."""
    title = "Answers to scenes with known conductivities"
    body = [f"<h1>{title}</h1>"]
    if len(files) > 1:
        body += _leaders(scores, accuracy)
    body += _by_scene(scores, accuracy, len(files))
    for answers in files:
        body += _every(answers, [score for score in scores if score.program == answers.program])
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
    head += f"<title>{title}</title><style>{STYLE}</style>"
    return "\n".join(
        ['<!DOCTYPE html>\n<html lang="en">', f"<head>{head}</head>", "<body>", *body, "</body></html>", ""]
    )


def _leaders(scores, accuracy):
    rows = [
        (each.program, each.reached, each.asked, short(each.factor), each.first) for each in standings(scores, accuracy)
    ]
    names = (
        "program",
        f"scenes known to {100 * accuracy:g} %",
        "of those answered",
        "times the cheapest",
        "cheapest on",
    )
    note = (
        "In the order of the number of scenes, then of the cost: its geometric mean over that of the cheapest program, "
        "on the scenes that a program knows to the accuracy. Costs are as each file declares them, or empty; "
        "of different machines they cannot be compared."
    )
    return ["<h2>Leaderboard</h2>", f'<p class="note">{note}</p>', _table(names, rows)]


def _by_scene(scores, accuracy, programs):
    best = cheapest(scores, accuracy)
    rows = [
        (scene if number == 0 else "", each.program, each.resolution, short(each.error, 100), *_costs(each))
        for scene, found in best.items()
        for number, each in enumerate(found)
    ]
    what = "Who gets there, the cheapest first" if programs > 1 else "The cheapest answer"
    names = ("scene", "program", "resolution", "error, %", "CPU s", "wall s", "MiB")
    return [f"<h2>{what}, to {100 * accuracy:g} %</h2>", _table(names, rows)]


def _every(answers, scores):
    names = ("scene", "resolution", "error, %", "known to, %", "interval", "CPU s", "wall s", "MiB", "remarks")
    rows = [
        (each.scene, each.resolution, short(each.error, 100), short(each.known_to, 100), each.interval, *_costs(each))
        + (each.remarks,)
        for each in scores
    ]
    told = [answers.version and f"Version {answers.version}", answers.method]
    told += [f"costs on {answers.machine}" if answers.machine else "the machine of its costs is not told"]
    head = f"<h2>{escape(answers.program)}: every answer</h2>"
    return [head, f'<p class="note">{escape("; ".join(filter(None, told)))}</p>', _table(names, rows)]


def _costs(score):
    return tuple(short(value) for value in (score.cpu_s, score.wall_s, score.memory_mib))


def _table(names, rows):
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    lines = ("".join(_cell(value) for value in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>\n" for line in lines)
    return f'<div class="scroll"><table><tr>{head}</tr>\n{body}</table></div>'


def _cell(value):
    text = str(value)
    kind = "number" if text.replace(".", "").replace("-", "").replace("e", "").replace("+", "").isdigit() else ""
    kind = "bad" if text.startswith(("misses", "beyond")) else kind
    return f'<td class="{kind}">{escape(text)}</td>' if kind else f"<td>{escape(text)}</td>"
