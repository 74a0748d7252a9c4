"""How figures look: one style, and colours that colour-blind readers tell apart (Okabe and Ito 2008)."""

from __future__ import annotations

from demheat.gallery import EDGE

BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PINK, BLACK, GREY = "#56B4E9", "#CC79A7", "#000000", "#7F7F7F"

STYLE = {
    "figure.dpi": 100,
    "savefig.dpi": 160,
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

# Name of a method in `harness.methods` -> label, colour, marker, line style: one method looks the same everywhere.
LOOK = {
    "dem": ("DEM, conforming Laguerre (default)", RED, "o", "-"),
    "dem-plain": ("DEM, Laguerre on the plain packing", ORANGE, "o", "--"),
    "dem-mean": ("DEM, Laguerre on the plain packing, arithmetic", ORANGE, "v", ":"),
    "dem-calibrated": ("DEM as in the paper, harmonic", PINK, "s", "--"),
    "dem-arithmetic": ("DEM as in the paper, arithmetic", PINK, "v", ":"),
    "fem": ("FEM, P2 on curved elements", BLUE, "^", "-"),
    "fem-straight": ("FEM, P2 on straight elements", BLUE, "^", "--"),
    "fem-p1": ("FEM, P1", SKY, "^", ":"),
    "fft": ("FFT, scalar CG, laminate voxels", GREEN, "D", "-"),
    "fft-plain": ("FFT, scalar CG, plain voxels", GREEN, "D", ":"),
    "fft-em": ("FFT, Eyre-Milton, laminate voxels", BLACK, "x", "-"),
    "fft-em-plain": ("FFT, Eyre-Milton, plain voxels", BLACK, "x", ":"),
    "maxwell": ("Maxwell", GREY, "", "-."),
    "exact": ("exact (Rayleigh)", BLACK, "", "-"),
}


def look(name, **more):
    """Keywords of a line for a method: its label, colour, marker and line style."""
    label, colour, marker, style = LOOK[name]
    return {"label": label, "color": colour, "marker": marker, "linestyle": style} | more


def resolution(particles, size, voxels):
    """Resolution of a row in words; two of the three are not-a-number."""
    if particles == particles:
        return f"{particles:.0f} particles"
    if size == size:
        return f"h = {size / EDGE:.2g} L"
    return f"{voxels:.0f}^3 voxels" if voxels == voxels else ""
