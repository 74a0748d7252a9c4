"""Pictures of scenes, fields and comparisons, as matplotlib's figures: `figure.savefig("x.png")`.

`Scene.plot` and `Field.plot` are these. Figures are made without pyplot: nothing stays open and no display is needed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from demheat.field import Field, check_field
from demheat.runtime.extras import extra
from demheat.scene import Scene, check_scene
from demheat.scene.inputs import axis_number, finite, whole
from demheat.terminal.slices import filled, on_plane, plane

if TYPE_CHECKING:
    from matplotlib.figure import Figure

AXES = "xyz"
# Pixels along the longer side: phases are told at once, fields may be fitted at each.
PIXELS, FIELD_PIXELS = 241, 121
LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "um"), (1e-9, "nm"))
# The matrix grey, then colours that the colour-blind tell apart; more conductivities than that share a scale.
COLOURS = ("#d9d9d9", "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442")
POINT, BARS = "#0072b2", ("#f0f0f0", "#dadada")
# Of values: what differs by less is equal, and how far colours then reach.
EQUAL, FLAT = 1e-9, 0.01


def plot_scene(scene: Scene, *, pixels: int = PIXELS) -> Figure:
    """Three slices through the middle, coloured by conductivity, as a matplotlib Figure.

    Parameters
    ----------
    pixels : int
        Along the longer side.
    """
    check_scene(scene)
    whole("pixels", pixels, "an integer >= 1", lambda v: v >= 1)
    figure, panels = _figure(3)
    matrix, *others = scene.mean_conductivities.tolist()
    kinds = np.array([matrix, *sorted(set(others) - {matrix})])
    named = len(kinds) <= len(COLOURS)
    look = (
        _named(len(kinds))
        if named
        else {"cmap": "viridis", "vmin": kinds.min(), "vmax": kinds[np.isfinite(kinds)].max()}
    )
    for across, panel in enumerate(panels):
        points, mask = plane(scene, axis=across, at=scene.size[across] / 2, n=pixels)
        k = scene.mean_conductivities[scene.phase_at(points)]
        image = _shown(panel, scene, across, filled(mask, _place(kinds, k) if named else k), look)
        panel.set_title(f"{AXES[across]} = {_length(scene, scene.size[across] / 2)}")
    bar = figure.colorbar(image, ax=panels, shrink=0.8, label="conductivity, W/(m K)")
    if named:
        bar.set_ticks(range(len(kinds)), labels=[f"{k:.4g}" for k in kinds])
    return figure


def plot_field(field: Field, *, axis: int | None = None, at: float | None = None, pixels: int = FIELD_PIXELS) -> Figure:
    """Temperature and size of the flux over a plane, as a matplotlib Figure.

    Parameters
    ----------
    axis : {0, 1, 2}, optional
        The plane lies across it; by default one along the load.
    at : float, m, optional
        Where; by default in the middle.
    pixels : int
        Along the longer side.
    """
    check_field(field)
    scene = field.scene
    axis = across_of(scene) if axis is None else axis_number(axis)
    at = scene.size[axis] / 2 if at is None else finite("at", at, "a number of metres in the box")
    found = on_plane(field, axis=axis, at=at, n=pixels)
    figure, panels = _figure(2)
    size = np.linalg.norm(found.flux, axis=-1)
    for panel, values, cmap, label in (
        (panels[0], found.temperature, "inferno", _warmth(scene)),
        (panels[1], size, "viridis", "size of the flux, W/m2"),
    ):
        # A few corners with a flux without bound would hide all else.
        top = np.nanpercentile(values, 99.5) if panel is panels[1] else np.nanmax(values)
        low, top = _ends(np.nanmin(values), top)
        image = _shown(panel, scene, axis, values, {"cmap": cmap, "vmin": low, "vmax": top})
        figure.colorbar(image, ax=panel, shrink=0.8, label=label)
        panel.set_title(f"{AXES[axis]} = {_length(scene, at)}")
    return figure


def plot_comparison(scene, entries, bounds, temperature=None):
    """Conductivities with their intervals, bounds behind them, and a slice of temperature beside them."""
    figure, panels = _figure(1 if temperature is None else 2)
    panel = panels[0]
    least, most = _limits(entries)
    for (name, low, high, *_), colour in zip(bounds, BARS, strict=False):
        # Beside perfect conductors there is no upper one.
        panel.axvspan(
            low,
            high if np.isfinite(high) else max(low, most),
            color=colour,
            label=f"{name}: {low:.5g} to {high:.5g}",
            zorder=0,
        )
    for place, (_, k, low, high) in enumerate(entries):
        panel.plot([low, high], [place, place], color=POINT, linewidth=4, alpha=0.4, solid_capstyle="butt")
        # What lies beyond the picture is at its edge.
        mark = "o" if least <= k <= most else "<" if k < least else ">"
        panel.plot([min(max(k, least), most)], [place], mark, color=POINT, markersize=5, clip_on=False)
    panel.set_xlim(least, most)
    panel.locator_params(axis="x", nbins=5)
    panel.set_yticks(range(len(entries)), labels=[name for name, *_ in entries])
    panel.set_ylim(max(len(entries), 1) - 0.5, -0.5)
    panel.set_xlabel("effective conductivity, W/(m K)")
    if bounds:
        panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False, fontsize="small", title="bounds")
    if temperature is not None:
        axis = across_of(scene)
        image = _shown(panels[1], scene, axis, temperature, {"cmap": "inferno"})
        figure.colorbar(image, ax=panels[1], shrink=0.8, label=_warmth(scene))
        panels[1].set_title(f"{AXES[axis]} = {_length(scene, scene.size[axis] / 2)}")
    return figure


def colours_of(count: int) -> list[str]:
    """Colours of so many kinds as "#rrggbb", the matrix grey; of too many on a scale."""
    if count <= len(COLOURS):
        return list(COLOURS[:count])
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [COLOURS[0], *(to_hex(colormaps["viridis"](k / (count - 2))) for k in range(count - 1))]


def across_of(scene) -> int:
    """Axis across which a plane shows the load: z, or y if the load is along z."""
    if scene.periodic:
        load = int(np.argmax(np.abs(scene.gradient)))
    else:
        load = next((AXES.index(name[0]) for name in scene.walls or {} if name[0] in AXES), 0)
    return 1 if load == 2 else 2


def _warmth(scene):
    """The label of temperatures: a scene does not know its scale, but where only differences count, or kelvin alone."""
    return "temperature, K" if scene.periodic or scene.radiates else "temperature, K or C"


def _limits(entries):
    """Ends of the axis: around what has an interval, since formulas may be far off; around all if nothing has."""
    ends = np.array([entry[1:] for entry in entries if np.isfinite(entry[2])] or [entry[1:] for entry in entries])
    if not ends.size:
        return 0.0, 1.0
    low, high = float(np.nanmin(ends)), float(np.nanmax(ends))
    room = max(0.3 * (high - low), 1e-3 * abs(high), 1e-12)
    return low - room, high + room


def _figure(number):
    """A figure and its panels in a row."""
    with extra("a picture"):
        from matplotlib.figure import Figure

    figure = Figure(figsize=(4.0 * number + 1.4, 4.4), layout="constrained")
    return figure, np.atleast_1d(figure.subplots(1, number))


def _named(count):
    """A colour for each place, and the ends between them."""
    from matplotlib.colors import ListedColormap

    return {"cmap": ListedColormap(COLOURS[:count]), "vmin": -0.5, "vmax": count - 0.5}


def _place(kinds, values):
    """Which of the kinds each value is."""
    order = np.argsort(kinds)
    return order[np.searchsorted(kinds, values, sorter=order)].astype(float)


def _ends(low, top):
    """Ends of a scale of colours, apart where values differ by rounding alone, as on a plane along the walls."""
    most = max(abs(low), abs(top))
    pad = FLAT * (most or 1.0) if top - low <= EQUAL * most else 0.0
    return low - pad, top + pad


def _shown(panel, scene, across, values, look):
    """Draw the pixels of a plane."""
    one, two = (axis for axis in range(3) if axis != across)
    factor, unit = _unit(scene)
    extent = (0, scene.size[one] / factor, 0, scene.size[two] / factor)
    panel.set_xlabel(f"{AXES[one]}, {unit}")
    panel.set_ylabel(f"{AXES[two]}, {unit}")
    return panel.imshow(values, origin="lower", extent=extent, interpolation="nearest", **look)


def _unit(scene):
    return next((each for each in LENGTHS if max(scene.size) >= each[0]), LENGTHS[-1])


def _length(scene, value):
    factor, unit = _unit(scene)
    return f"{value / factor:.4g} {unit}"
