"""The report as one HTML page: no file, font or script from elsewhere, and room enough on a telephone."""

import re
from html import escape
from pathlib import Path

from studies.harness import sound
from studies.harness.outcomes import held_to
from studies.harness.pictures import embedded

CLASSES = {"ok": "ok", "check": "check", "FAIL": "fail", "not judged": "open"}
STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #1b1b1b; margin: 0 auto; max-width: 72rem; padding: 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.25rem; margin-top: 2rem; } h3 { font-size: 1.05rem; }
a { color: #0a58a5; } code { overflow-wrap: anywhere; }
.scroll { overflow-x: auto; margin: .8rem 0; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
th, td[style] { white-space: nowrap; }
.scroll table { width: max-content; } td { max-width: min(30rem, 55vw); }
th { background: #f3f3f3; }
img { max-width: 100%; min-width: 36rem; height: auto; } p:has(> img) { overflow-x: auto; }
details { border: 1px solid #ccc; border-radius: .4rem; margin: .5rem 0; padding: 0 .8rem; }
summary { cursor: pointer; padding: .6rem 0; overflow-wrap: anywhere; }
summary b { margin-right: .4rem; } summary small { display: block; color: #555; }
.ok, .check, .fail, .open { font-weight: 600; white-space: nowrap; }
.ok { color: #116329; } .check { color: #57606a; } .fail { color: #a40e26; } .open { color: #7a5200; }
.first li { margin: .5rem 0; } li small { display: block; color: #555; }
.note { background: #fff6df; border-left: .3rem solid #e0a800; padding: .5rem .8rem; }
"""
# A link to a study opens it; browsers that do so themselves do it twice.
SCRIPT = """
const open = () => { const at = document.getElementById(location.hash.slice(1));
  if (at && at.tagName === "DETAILS") { at.open = true; at.scrollIntoView(); } };
addEventListener("hashchange", open); open();
"""


def page(found, first, figures, out):
    """The whole page."""
    body = [
        "<h1>demheat: results</h1>",
        f'<p class="note">{len(found)} studies, {sound.total(found)}. A claim that rests on costs of such rows is not'
        " judged. Dirty: made by code of no commit. Noisy: while others used more than"
        f" {sound.NOISY:.0%} of the processors, or nobody knows.</p>",
        _contents(found),
        '<h2 id="first">Ten results first</h2>',
        f'<ol class="first">{"".join(_first(*each) for each in first)}</ol>',
        '<h2 id="figures">Figures of the papers</h2>',
        _mapped(figures, found),
        '<h2 id="all">All studies</h2>',
        *(_chapter(each, Path(out)) for each in found),
    ]
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
    head += f"<title>demheat: results</title><style>{STYLE}</style>"
    lines = ['<!DOCTYPE html>\n<html lang="en">', f"<head>{head}</head>", "<body>", *body]
    return "\n".join([*lines, f"<script>{SCRIPT}</script>", "</body>", "</html>", ""])


def _contents(found):
    parts = '<li><a href="#first">Ten results first</a></li><li><a href="#figures">Figures of the papers</a></li>'
    names = ", ".join(f'<a href="#{each.name}">{each.name}</a>' for each in found)
    return f'<nav><h2>Contents</h2><ul>{parts}<li><a href="#all">All studies</a>: {names}</li></ul></nav>'


def _first(name, claim):
    verdict = f'<span class="{CLASSES[claim.verdict]}">{claim.verdict}</span>'
    where = f'<a href="#{name}">{name}</a>' + (f"; {escape(claim.why)}" if claim.why else "")
    value = f": <b>{claim.value:.3g}</b>" if claim.value == claim.value else ""
    limit = f"limit {escape(claim.limit)}; " if claim.limit else ""
    return f"<li>{verdict} {escape(claim.sentence)}{value}<small>{limit}{where}</small></li>"


def _mapped(figures, found):
    there = {each.name for each in found}
    papers = dict.fromkeys(paper for paper, _, name, _ in figures if name in there)
    return "".join(f"<h3>{escape(each)}</h3><ul>{_of_paper(each, figures, found)}</ul>" for each in papers)


def _of_paper(paper, figures, found):
    mine = [each for each in figures if each[0] == paper]
    asked = [(what, name, words, held_to(found, name, words)) for _, what, name, words in mine]
    return "".join(
        f'<li>{escape(what)}: <a href="#{name}">{name}</a>{_outcomes(claims, words)}</li>'
        for what, name, words, claims in asked
        if claims is not None
    )


def _outcomes(claims, words):
    return "".join(_outcome(*each) for each in claims) if claims else f"<small>{escape(str(words))}</small>"


def _outcome(outcome, claim, why):
    verdict = f'<span class="{CLASSES[claim.verdict]}">{outcome}</span>'
    return f"<small>{verdict} {escape(claim.sentence)}: {claim.value:.3g} ({escape(claim.limit)}) {escape(why)}</small>"


def _chapter(each, folder):
    said = f"{each.verdicts}; {each.rows} rows: {sound.in_words(each.count)}" if not each.problem else each.problem
    head = f"<summary><b>{each.name}</b>{escape(each.title)}<small>{escape(said)}</small></summary>"
    body = converted(each.text.partition("\n")[2], folder) if not each.problem else ""
    return f'<details id="{each.name}">{head}{body}</details>'


def converted(text, folder):
    """A study's page in Markdown as HTML: wide tables scroll by themselves, pictures are in it."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False}).enable("table")
    reader.add_render_rule("table_open", lambda *_: '<div class="scroll"><table>\n')
    reader.add_render_rule("table_close", lambda *_: "</table></div>\n")
    tokens = reader.parse(text)
    for token in (part for each in tokens for part in (each, *(each.children or ()))):
        if token.type in ("heading_open", "heading_close"):
            token.tag = "h3"
        elif token.type == "image":
            file = Path(folder) / token.attrs["src"]
            token.attrs["src"] = embedded(file) if file.exists() else ""
    html = reader.renderer.render(tokens, reader.options, {})
    return re.sub(
        r"<td>(ok|check|FAIL|not judged)</td>", lambda found: f'<td class="{CLASSES[found[1]]}">{found[1]}</td>', html
    )
