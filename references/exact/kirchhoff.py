"""Bodies whose conductivity depends on temperature: Kirchhoff's transform, and layers one after the other.

Where all phases follow the temperature by the same factor, its integral theta obeys the linear equation of the
conductivities at factor 1 (G. Kirchhoff, Vorlesungen ueber die Theorie der Waerme, 1894): same flux, and walls held at
the theta of their temperatures. Where they differ theta jumps at interfaces; in layers that heat crosses one after the
other the flux is still one number, the root of the temperature that it leaves at the end.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from demheat.scene import Dependence, Flux, Layer, Scene
from references.exact.forms import Closed, pieces

# Of the flux: what Brent's method is asked for, and the least that it takes; and more than rounding of its ends.
DIGITS, ROUNDING = 4 * np.finfo(float).eps, 1e-9


def linear(scene: Scene) -> tuple[Scene, Dependence] | None:
    """The linear scene whose temperature is Kirchhoff's transform of that of a scene.

    Parameters
    ----------
    scene : Scene
        Between walls.

    Returns
    -------
    Scene
        Without dependence, its walls held at the transforms of their temperatures, fluxes as they were.
    Dependence
        Of all that conducts: its `inverse` takes the temperature back.
        None instead of both, if phases differ in their dependence, surfaces resist or walls exchange heat.

    Examples
    --------
    >>> from demheat import Material, Scene
    >>> from references.exact.kirchhoff import linear
    >>> iron = Material(80.0, dependence=[(0.0, 1.0), (100.0, 0.8)])
    >>> found = linear(Scene((1.0, 1.0, 1.0), iron, walls={"x-": 0.0, "x+": 100.0}))
    >>> if found is not None:  # as it is where walls exchange heat
    ...     transformed, own = found
    ...     print(transformed.wall_temperatures["x+"], own.inverse(90.0))
    90.0 100.0
    """
    kinds = {each.dependence for each in scene.materials if each.mean_conductivity > 0}
    if len(kinds) != 1 or None in kinds or scene.resistances.any() or scene.wall_exchanges or scene.periodic:
        return None
    (own,) = kinds
    shapes = [replace(each, material=replace(each.material, dependence=None)) for each in scene.inclusions]
    walls = {name: load if isinstance(load, Flux) else _integral(own, load) for name, load in scene.walls.items()}
    return replace(scene, matrix=replace(scene.matrix, dependence=None), inclusions=shapes, walls=walls), own


def transformed(scene: Scene, form: Callable[[Scene], Closed | None]) -> Closed | None:
    """A form of the linear scene, taken back."""
    found = linear(scene)
    closed = form(found[0]) if found else None
    if closed is None:
        return None
    own = found[1]
    return closed._replace(
        form=f"{closed.form}, Kirchhoff", temperature=lambda points: own.inverse(closed.temperature(points))
    )


def layers(scene: Scene) -> Closed | None:
    """Layers, each with its own dependence, between two isothermal walls across which they are stacked."""
    if scene.anisotropic or not scene.only(Layer) or not scene.conductivities.all():
        return None
    names = sorted(scene.wall_temperatures)
    if len(names) != 2 or len(scene.walls) != 2 or names[0][0] != names[1][0]:
        return None
    normal = scene.axis
    if any(layer.axis != normal for layer in scene.inclusions):
        return None
    stack = _Stack(scene, normal)
    flux = stack.flux()
    starts = stack.march(flux)

    def temperature(points):
        x = points[:, normal]
        piece = np.clip(np.searchsorted(stack.breaks, x, side="right") - 1, 0, len(stack.phase) - 1)
        return stack.within(starts[piece], flux, piece, x - stack.breaks[piece])

    mean = np.where(np.arange(3) == normal, flux, 0.0)
    stats = {"unknowns": 1, "digits": 13.0}
    form = "layers that follow the temperature"
    return Closed(form, temperature, lambda points: np.tile(mean, (len(points), 1)), mean, normal, stack.breaks, stats)


class _Stack:
    """Layers along an axis, and the walls at their ends."""

    def __init__(self, scene, normal):
        self.breaks, self.phase, self.resist = pieces(scene, normal)
        self.k, self.depends = scene.conductivities[self.phase], scene.dependences
        self.low, self.high = (scene.wall_temperatures["xyz"[normal] + side] for side in "-+")

    def within(self, start, flux, piece, depth):
        """Temperature at depths in pieces that begin at temperatures."""
        phase = self.phase[piece]
        return self.depends.inverse(phase, self.depends.integral(phase, start) - flux * depth / self.k[piece])

    def march(self, flux):
        """Temperature where each piece begins, and at the end of all, (pieces + 1,) float array."""
        found = [np.array(self.low)]
        for piece, depth in enumerate(np.diff(self.breaks)):
            end = self.within(found[-1], flux, piece, depth)
            found.append(end - flux * self.resist[piece + 1])
        return np.array(found)

    def flux(self):
        """Flux density that takes the low wall's temperature to the high one's."""
        if self.low == self.high:
            return 0.0
        least, most = (self._at_factors(extreme) for extreme in (np.min, np.max))
        # Wider than their rounding.
        ends = least * (1 - ROUNDING), most * (1 + ROUNDING)
        return float(brentq(lambda q: self.march(q)[-1] - self.high, *ends, xtol=DIGITS * abs(least), rtol=DIGITS))

    def _at_factors(self, extreme):
        """Flux density if each piece had the least, or the largest, of its factors between the two walls."""
        ends = sorted((self.low, self.high))
        knots = [t for own in self.depends.kinds for t, _ in own.points if ends[0] < t < ends[1]]
        factors = [self.depends.factor(self.phase, np.full(len(self.phase), t)) for t in (*ends, *knots)]
        each = np.diff(self.breaks) / (self.k * extreme(factors, axis=0))
        return (self.low - self.high) / (each.sum() + self.resist.sum())


def _integral(own, load):
    return float(own.integral(np.float64(load)))
