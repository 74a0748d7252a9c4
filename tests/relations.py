"""Relations between two scenes whose solutions follow from each other, and how far a method's solutions are from that.

Nothing here knows a right value: a scene is moved, turned, mirrored, measured in other units, told in another order,
doubled, or loaded otherwise, and the method is asked again.
"""

import inspect
from functools import cache
from typing import NamedTuple

import numpy as np
from changed_scenes import RELATIONS
from drawn_scenes import drawn, kind
from method_scenes import METHODS, Estimated, answered, asked, resting

from demheat import referee
from demheat.method import DEGREE
from studies.harness import methods

# Points at which two fields are compared.
POINTS = 60
# In time all is at rest after so many seconds: of 1 J/(m3 K) behind layers a hundredth as conducting as the matrix.
AT_REST, ACCURACY = 1e4, 1e-3
# What is left then of temperatures where they are solved for; found: 6e-6 at most, by methods of the paper.
LEFT = 1e-4
# Closed forms and formulas: sums of some hundred rounded numbers.
ROUNDING = 1e-12
# Solvers' tolerances at that resolution, 1e-9 or 1e-11, times the condition of the equations; as in `test_methods`.
IDENTITY = 1e-7
# Two solutions on unlike elements, each within its own error. That declared is of contrast 10; at 100 it is up to twice
# as large, but with arithmetic means at interfaces, which grow with the contrast itself, ten times.
APART, ARITHMETIC = 4.0, 20.0


class Spread(NamedTuple):
    """Differences between two solutions of which one follows from the other."""

    conductivity: float  # Size of the difference of mean fluxes over that of the mean flux
    # Root mean square over the imposed span; not-a-number of what knows the conductivity alone
    temperature: float = np.nan
    flux: float = np.nan  # Root mean square over the mean flux; as the temperature
    places: float = np.nan  # In time, of temperatures where they are solved for, in particles; else not-a-number


def exact(method, relation):
    """Whether a relation is to hold to rounding and the solver's tolerance, by what the method declares."""
    if method.resolution in (None, DEGREE):
        return True
    turns = "rotation" not in method.exceptions
    kept = {"all": True, "but meshes": turns or method.resolution.seeded, "grids": turns, "none": False}
    return kept[RELATIONS[relation].kept_by]


def limit(method, relation, part):
    """Largest spread that a method may have."""
    if relation == "time":
        # In time points are asked of other polynomials than at rest: each has errors of its own. Of plain packings with
        # arithmetic means temperatures at points are 2.2e-3 apart, in the particles themselves 7e-10.
        own = {"temperature": ACCURACY, "flux": ACCURACY} if method.errors is None else method.errors._asdict()
        return {**own, "conductivity": ACCURACY, "places": LEFT}[part]
    if method.resolution is None:
        return ROUNDING
    if exact(method, relation) or method.errors is None:
        return IDENTITY
    apart = ARITHMETIC if method.knobs.get("interface") == "arithmetic" else APART
    return apart * getattr(method.errors, part)


def image_of(relation, seed):
    """The image of a drawn scene, the same at every call; None of one that the relation says nothing of."""
    return RELATIONS[relation].image(drawn(seed), np.random.default_rng([seed, 21]))


@cache
def first(name, seed):
    """The solution of a drawn scene by a method; None if it has no closed form."""
    return _known(METHODS[name], drawn(seed))


def _known(method, scene, **knobs):
    try:
        return answered(method, scene, **knobs)
    except NotImplementedError:
        if method.resolution is not None:
            raise
        return None


def applies(name, relation, seed):
    """Whether a method is asked for a relation on a drawn scene: it refuses neither of the two."""
    method, image = METHODS[name], image_of(relation, seed)
    if image is None or (image.in_time and not _evolves(method)):
        return False
    if (asked(drawn(seed)) | asked(image.scene)) & set(method.refuses):
        return False
    # Of layers a method that is not exact there declares no error.
    if kind(seed) == "layers" and "laminate" in method.exceptions and not exact(method, relation):
        return False
    # Closed forms are of fewer scenes than such words can say, and of cells, not of pairs of them.
    return method.resolution is not None or second(name, relation, seed) is not None


def _evolves(method):
    """Whether the method's module also has a transient of the same discretisation."""
    module = methods.load(method.module)
    if not hasattr(module, "evolve") or method.call != "solve":
        return False
    taken, usual = (inspect.signature(getattr(module, call)).parameters for call in ("evolve", "solve"))
    if "accuracy" not in taken:
        return False
    some = any(each.kind is each.VAR_KEYWORD for each in taken.values())
    return some or all(name in taken or usual[name].default == value for name, value in method.knobs.items())


@cache
def second(name, relation, seed):
    """The solution of an image, on elements of the size of the first's; None if either has no closed form."""
    method, image = METHODS[name], image_of(relation, seed)
    if first(name, seed) is None:
        return None
    if image.in_time:
        return _last(method, image.scene)
    return _known(method, image.scene, capacity=image.capacity, **_size(method, image, max(drawn(seed).size)))


def _size(method, image, edge):
    """Knobs of the same size of elements in an image of a box of an edge."""
    if image.cells == 1 or method.resolution in (None, DEGREE):
        return {}
    refined = method.resolution
    if refined.metric:
        return method.at(method.coarse, edge)
    longer = image.cells if refined.seeded else max(image.scene.size) / edge
    return {refined.knob: round(method.coarse * longer)}


def _last(method, scene):
    evolve = methods.load(method.module).evolve
    taken = inspect.signature(evolve).parameters
    some = any(each.kind is each.VAR_KEYWORD for each in taken.values())
    knobs = {name: value for name, value in method.knobs.items() if some or name in taken}
    knobs |= {name: value for name, value in method.tight.items() if name in taken}
    *_, last = evolve(
        resting(scene), (AT_REST,), **knobs, **method.at(method.coarse, max(scene.size)), accuracy=ACCURACY
    )
    return last


def _mean_flux(field, image):
    """The mean flux; of what came to rest in time that through the walls, as a transient's mean is another number."""
    if not image.in_time:
        return field.mean_flux
    axis = field.scene.axis
    wall = "xyz"[axis] + "-"
    return np.eye(3)[axis] * field.wall_heat[wall] * field.scene.size[axis] / field.scene.volume


def spread(name, relation, seed):
    """How far two solutions by a method are from what a relation says."""
    image = image_of(relation, seed)
    one, two = first(name, seed), second(name, relation, seed)
    if isinstance(one, Estimated):
        return Spread(abs(two.conductivity / (image.conductivity * one.conductivity) - 1))
    scale = abs(image.flux) * np.linalg.norm(one.mean_flux)
    k = np.linalg.norm(_mean_flux(two, image) - image.flux * image.mean_turn @ _mean_flux(one, image)) / scale
    points = np.random.default_rng(seed).random((POINTS, 3)) * one.scene.size
    there = image.points(points)
    warmer = two.temperature_at(there) - image.warmth * one.temperature_at(points) - image.level
    warmer -= warmer.mean() if one.scene.periodic else 0.0
    span = abs(image.warmth) * referee.span(one.scene)
    more = two.flux_at(there) - image.flux * one.flux_at(points) @ image.turn.T
    found = [warmer / span, more / scale]
    if image.in_time:
        found.append((two.samples.temperature - image.warmth * one.samples.temperature - image.level) / span)
    rms = [float(np.sqrt(np.mean(np.sum(np.atleast_2d(v.T) ** 2, axis=0)))) for v in found]
    return Spread(float(k), *rms)
