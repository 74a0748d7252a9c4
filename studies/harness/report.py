"""All studies of a folder in one report: their pages, a short README.md, and index.html that needs no other file."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from demheat.runtime.paths import replaced
from studies.harness import explained, runner, sound
from studies.harness.claims import CHECK, NEAR, Claim
from studies.harness.outcomes import held_to
from studies.harness.table import render

VERDICTS = ("ok", "FAIL", "not judged", CHECK)


class Chapter(NamedTuple):
    """One study of a report; `problem` says why it has no page, `fails` which claims fail, and why."""

    name: str
    title: str
    claims: list[Claim]
    text: str
    rows: int
    count: dict[str, int]
    problem: str = ""
    fails: Sequence[tuple[Claim, str]] = ()

    @property
    def verdicts(self):
        """Numbers of claims by verdict, in words."""
        found = Counter(each.verdict for each in self.claims)
        parts = [f"{found[word]} {word}" for word in VERDICTS if found[word]]
        return ", ".join(parts) + ("s" if found[CHECK] > 1 else "")


def chapters(names, out):
    """Render every study that has rows in a folder; one whose rows cannot be read is a chapter that says so."""
    paths = {name: runner.csv_of(name, out) for name in names}
    found = [_chapter(name, path) for name, path in paths.items() if path.exists()]
    if not found:
        raise ValueError(f"no results in {out}; run a study first")
    return found


def _chapter(name, path):
    study = runner.load(name)
    title = (study.__doc__ or name).strip().splitlines()[0]
    try:
        claims, text = render(study, path)
    except ValueError as error:
        return Chapter(name, title, [], "", 0, dict.fromkeys(sound.FAULTS, 0), str(error))
    found = sound.checked(study, path)
    fails = [(each, explained.why(study, each)) for each in claims if each.failed]
    return Chapter(name, title, claims, text, len(found), sound.counted(found.values()), fails=fails)


def headlines(found, wanted):
    """Claims of the chapters that are wanted first."""
    claims = {each.name: each.claims for each in found}
    picked = []
    for name, words in wanted:
        fits = [each for each in claims.get(name, ()) if words in each.sentence]
        lost = f"{len(fits) or 'no'} claims with these words" if name in claims else "the study has no rows here"
        picked.append((name, fits[0] if len(fits) == 1 else Claim(words, float("nan"), "", False, lost)))
    return picked


def write(found, out, contents):
    """Write README.md and index.html into a folder and return their paths."""
    from studies.harness.html import page

    first = headlines(found, contents.HEADLINES)
    texts = {
        "README.md": readme(found, first, contents.FIGURES),
        "index.html": page(found, first, contents.FIGURES, out),
    }
    for name, text in texts.items():
        with replaced(Path(out) / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    return [Path(out) / name for name in texts]


def readme(found, first, figures):
    """The short page that leads to those of the studies, in Markdown."""
    claims = [
        f"| {each.verdict} | {_cell(each.sentence)} | {each.value:.3g} | {each.limit} | [{name}]({name}.md) |"
        for name, each in first
    ]
    lines = [_line(each) for each in found]
    return "\n".join(
        [
            "# Results\n",
            f"{len(found)} studies, {sound.total(found)}. Costs of these count in no claim.",
            "The same as one page, with all tables and figures: [index.html](index.html).\n",
            "Written by `python -m studies report`; how to read and repeat it: [studies](../docs/studies.md).\n",
            "Ten results first; then [figures of the papers](#figures-of-the-papers), [all studies](#all-studies) and "
            "[claims that fail](#claims-that-fail).\n",
            "## Ten results first\n",
            "|  | claim | value | limit | study |\n|---|---|--:|---|---|",
            *claims,
            "\n## Figures of the papers\n",
            "What a paper prints, asked of its own network or rule. Reproduced: within the limit of the claim, which is"
            " what is printed, its last digit, or, of Figs. 7 and 8, a factor.\n",
            "| paper | what | study | | claim | value | limit | why |\n|---|---|---|---|---|--:|---|---|",
            *(line for each in figures for line in _of_figure(found, *each)),
            "\n## All studies\n",
            "| study | what | claims | rows | whose costs do not count |\n|---|---|---|--:|---|",
            *lines,
            "\n## Claims that fail\n",
            f"{sum(len(each.fails) for each in found)} of {sum(len(each.claims) for each in found) - _checks(found)},"
            " each with its reason where one is known.\n",
            "| study | claim | value | limit | why |\n|---|---|--:|---|---|",
            *_failed(found),
            f"\n{_near(found)}",
            "",
        ]
    )


def _of_figure(found, paper, what, name, words):
    asked, head = held_to(found, name, words), f"| {paper} | {what} | [{name}]({name}.md) |"
    if asked == []:
        return [f"{head} | | | | {_cell(words) if isinstance(words, str) else ''} |"]
    return [
        f"{head} {outcome} | {_cell(claim.sentence)} | {claim.value:.3g} | {claim.limit} | {_cell(why)} |"
        for outcome, claim, why in asked or ()
    ]


def _near(found):
    return (
        f"{_checks(found)} more are no claims but checks that later code does as well: their limit is within {NEAR:g} "
        "times the value, and most were set, or came down to that, after the value was seen "
        "([claims](../docs/decisions/claims.md)). So near a limit is a claim's where it is from elsewhere: what a "
        "paper prints, a rate, statistics, a guess or an aim that was written down before."
    )


def _checks(found):
    return sum(each.verdict == CHECK for chapter in found for each in chapter.claims)


def _failed(found):
    return [
        f"| [{name}]({name}.md) | {_cell(claim.sentence)} | {claim.value:.3g} | {claim.limit} | {_cell(why)} |"
        for name, fails in ((each.name, each.fails) for each in found)
        for claim, why in fails
    ]


def _cell(text):
    return text.replace("|", "\\|")


def _line(each):
    if each.problem:
        return f"| {each.name} | {each.title} | {each.problem} | | |"
    count = sound.in_words(each.count)
    return f"| [{each.name}]({each.name}.md) | {each.title} | {each.verdicts} | {each.rows} | {count} |"
