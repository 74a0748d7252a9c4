"""How figures look: one style, and colours that colour-blind readers tell apart (Okabe and Ito 2008)."""

import numpy as np

from studies.harness import methods

BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PINK, BLACK, GREY = "#56B4E9", "#CC79A7", "#000000", "#7F7F7F"

STYLE = {
    "figure.dpi": 100,
    "savefig.dpi": 160,
    # Names inside of a vector copy are the same each time.
    "svg.hashsalt": "demheat",
    "savefig.bbox": "tight",
    "figure.constrained_layout.use": True,
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "lines.linewidth": 1.6,
    "lines.markersize": 6,
}

# Names of colours in a method's own `look`.
COLOURS = {
    "blue": BLUE,
    "orange": ORANGE,
    "green": GREEN,
    "red": RED,
    "sky": SKY,
    "pink": PINK,
    "black": BLACK,
    "grey": GREY,
}
# One method looks the same everywhere: its name -> label, colour, marker, line.
LOOK = {
    name: (method.label, COLOURS.get(method.look[0], method.look[0]), *method.look[1:])
    for name, method in methods.all_methods().items()
}


def look(name, **more):
    """Keywords of a line for a method: its label, colour, marker and line style."""
    label, colour, marker, style = LOOK[name]
    return {"label": label, "color": colour, "marker": marker, "linestyle": style} | more


# What is nearer to nothing, or farther from its limit, than by this factor is drawn there; letters of a sentence.
FARTHEST, LONGEST = 1e3, 90
# What an interval misses, drawn about the method's own mark: no method has this.
MISS = {"linestyle": "", "marker": "o", "color": BLACK, "markerfacecolor": "none", "markersize": 11, "zorder": 4}
VERDICTS = {"ok": BLUE, "check": SKY, "FAIL": RED, "not judged": GREY}


def of_claims(claims):
    """How near each claim is to its limit: what a study shows that has no figure of its own."""
    from matplotlib import pyplot

    shown = [each for each in claims if np.isfinite(each.value)][::-1]
    used = 1 / np.clip([each.room for each in shown], 1 / FARTHEST, FARTHEST)
    figure, axes = pyplot.subplots(figsize=(11, 1.2 + 0.2 * len(shown)))
    for verdict, colour in VERDICTS.items():
        here = [number for number, each in enumerate(shown) if each.verdict == verdict]
        axes.plot(used[here], here, "o", color=colour, label=verdict)
    axes.axvline(1.0, color=BLACK, linewidth=1)
    axes.set(xscale="log", xlim=(0.7 / FARTHEST, 1.4 * FARTHEST), ylim=(-0.7, len(shown) - 0.3))
    axes.set_xlabel("value over its limit, or the limit over a value that is to be larger")
    axes.set_yticks(range(len(shown)), [_short(each.sentence) for each in shown], fontsize=7)
    figure.legend(loc="outside lower right", ncols=4)
    return figure


def _short(sentence):
    return sentence if len(sentence) <= LONGEST else f"{sentence[: LONGEST - 3]}..."
