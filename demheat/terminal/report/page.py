"""The page: its parts in order, each made of what has been computed before."""

import base64
import io
import json
from html import escape
from pathlib import Path
from typing import NamedTuple

from demheat.terminal.pictures import colours_of
from demheat.terminal.report.volume import Kinds, Values
from demheat.version import __version__

HERE = Path(__file__).parent
CITE = f"""@software{{demheat,
  title   = {{demheat: heat conduction in heterogeneous solids by the discrete element method, beside FEM, FFT,
             exact solutions and bounds}},
  author  = {{{{the demheat authors}}}},
  version = {{{__version__}}},
  license = {{MIT}}
}}"""


class Content(NamedTuple):
    """What stands on the page."""

    title: str
    line: str  # The scene in words
    source: str  # Its file
    kinds: Kinds
    size: tuple[float, float, float]
    values: tuple[str, list[Values]]  # The method whose field is drawn, and its values
    figures: dict  # Figures of matplotlib by what they show
    rows: list[tuple[str, ...]]  # Answers, their heads first
    told: list[str]  # Warnings, refusals
    assumed: list[str]


def page(content: Content) -> str:
    """The whole page."""
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
    css, script = (HERE.joinpath(name).read_text(encoding="utf-8") for name in ("page.css", "view.js"))
    parts = [
        f"<h1>{escape(content.title)}</h1><p>{escape(content.line)}</p>",
        "<h2>The scene</h2>" + _view(content),
        "<h2>Answers</h2>" + _table(content.rows) + _list(content.told) + _figure(content.figures, "answers"),
        *(f"<h2>{escape(name)}</h2>" + _figure(content.figures, name) for name in content.figures if name[0].isupper()),
        "<h2>What was assumed</h2>" + _list(content.assumed),
        f"<details><summary>The file</summary><pre>{escape(content.source)}</pre></details>",
        f"<h2>How to cite</h2><pre>{escape(CITE)}</pre><p>Besides, the sources of the methods that were used: the "
        "manual's page on results names them.</p>",
    ]
    data = json.dumps(_data(content)).replace("</", "<\\/")
    call = f'view(document.querySelector(".view"), {data});'
    head += f"<title>{escape(content.title)}</title><style>{css}</style>"
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>'
        f"<body>{''.join(parts)}<script>{script}\n{call}</script></body></html>\n"
    )


def _data(content):
    values = [{"shape": each.shape, "content": each.content} for each in content.values[1]]
    size = [side / max(content.size) for side in content.size]
    colours = [[*_rgb(colour), 1.0 if shown else 0.0] for colour, shown in _colours(content.kinds)]
    return {"shape": content.kinds.shape, "kinds": content.kinds.content, "size": size, "colours": colours} | {
        "values": values
    }


def _colours(kinds):
    """Colour of each kind, and whether it is shown at first: what is around the others is not."""
    count = len(kinds.conductivity)
    return [(colour, count == 1 or place > 0) for place, colour in enumerate(colours_of(count))]


def _rgb(colour):
    return [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]


def _view(content):
    """The canvas with what changes it, and the picture that stays where the browser draws nothing."""
    cuts = "".join(
        f'<label>cut {name} <input type="range" min="0.01" max="1" step="0.01" value="1" data-cut="{axis}"></label>'
        for axis, name in enumerate("xyz")
    )
    tools = [_choices(*content.values), _boxes(content.kinds), cuts, "drag to turn, wheel to zoom"]
    return (
        '<div class="view"><div class="stage">'
        '<canvas tabindex="0" aria-label="the scene, to turn by dragging"></canvas>'
        + "".join(f"<span data-axis>{name}</span>" for name in "xyz")
        + "</div>"
        + "".join(f'<div class="tools">{each}</div>' for each in tools)
        + f'<div class="still">{_figure(content.figures, "scene")}</div></div>'
    )


def _boxes(kinds):
    """A box to tick for each conductivity."""
    found = ["show"]
    for place, (k, (colour, shown)) in enumerate(zip(kinds.conductivity, _colours(kinds), strict=True)):
        ticked, swatch = " checked" if shown else "", f'<span class="swatch" style="background:{colour}"></span>'
        found.append(f'<label><input type="checkbox" data-kind="{place}"{ticked}>{swatch}{k:.4g}</label>')
    return " ".join([*found, "W/(m K)"])


def _choices(method, values):
    """What the colours are of, and their scales."""
    if not values:
        return ""
    names = ["conductivity", *(f"{each.name} by {method}" for each in values)]
    found = []
    for place, name in enumerate(names, start=-1):
        ticked = " checked" if place < 0 else ""
        found.append(f'<label><input type="radio" name="field" value="{place}"{ticked}>{escape(name)}</label>')
    for place, each in enumerate(values):
        ends = f'{each.least:.4g}<span class="scale"></span>{each.most:.4g} {escape(each.unit)}'
        found.append(f'<span data-scale="{place}" hidden>{ends}</span>')
    return "".join(found)


def _figure(figures, name):
    """A figure of matplotlib as a picture within the page."""
    if name not in figures:
        return ""
    held = io.BytesIO()
    figures[name].savefig(held, format="png", dpi=110)
    text = base64.b64encode(held.getvalue()).decode()
    return f'<p class="figure"><img alt="{escape(name)}" src="data:image/png;base64,{text}"></p>'


def _table(rows):
    head, *others = rows
    cells = "".join(f"<th>{escape(each)}</th>" for each in head)
    lines = ["<tr>" + "".join(f"<td>{escape(each)}</td>" for each in row) + "</tr>" for row in others]
    return f'<div class="wide"><table><tr>{cells}</tr>{"".join(lines)}</table></div>'


def _list(lines):
    return f"<ul>{''.join(f'<li>{escape(each)}</li>' for each in lines)}</ul>" if lines else ""
