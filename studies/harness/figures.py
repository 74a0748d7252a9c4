"""How figures look: one style, and colours that colour-blind readers tell apart (Okabe and Ito 2008)."""

from __future__ import annotations

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

# One method looks the same everywhere: its name -> label, colour, marker, line.
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
LOOK = {
    name: (method.label, COLOURS.get(method.look[0], method.look[0]), *method.look[1:])
    for name, method in methods.all_methods().items()
}


def look(name, **more):
    """Keywords of a line for a method: its label, colour, marker and line style."""
    label, colour, marker, style = LOOK[name]
    return {"label": label, "color": colour, "marker": marker, "linestyle": style} | more
