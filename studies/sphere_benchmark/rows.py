"""A row: one scene by one method, its errors against what is known; or two scenes that a relation ties."""

import copy

import numpy as np

import benchmark
from demheat import referee
from demheat.io.known import known_of, scene_of
from demheat.terminal.commands.scores import span_of
from studies.harness.cost import measured

# Spheres between walls, with no symmetry.
RELATED = "dispersion-walls"
FACTOR = 7.0
AXES = "xyz"


def solved(scene, way) -> dict:
    """Solve a scene and hold it against what is known."""
    table = benchmark.read(scene)
    known = known_of(table)
    answer, cost = measured(way, table)
    row = {"known": known.conductivity, "conductivity": answer.conductivity}
    at_points, asking = measured(_at_points, answer, table, known)
    row |= at_points | {"points_cpu_s": asking["cpu_s"] if at_points else None}
    if known.conductivity is not None:
        row["error_percent"] = 100 * referee.value_error(answer.conductivity, known.conductivity)
    elif at_points:
        row["error_percent"] = at_points["worst_percent"]
    else:
        raise NotImplementedError("temperatures are asked for: its fields have no temperature_at(points)")
    return row | cost | answer.stats


def _at_points(answer, table, known):
    """Errors at the file's points; none without fields there."""
    fields = [field for field in answer.fields if hasattr(field, "temperature_at")]
    if not fields or not len(known.positions):
        return {}
    scene = scene_of(table)
    found = _temperatures(fields, known)
    if scene.periodic:
        found = found - found[0]
    span = span_of(scene, known.temperature)
    off = referee.value_error(found, known.temperature, scale=span)
    row = {"temperature_percent": 100 * referee.rms(off), "worst_percent": 100 * float(np.abs(off).max())}
    if known.flux is not None and hasattr(fields[0], "flux_at"):
        # The mean flux is that of the conductivity.
        slope = np.linalg.norm(scene.gradient) if scene.periodic else span / scene.size[scene.axis]
        apart = np.asarray(fields[0].flux_at(known.positions)) - known.flux
        row["flux_percent"] = 100 * referee.rms(np.linalg.norm(apart, axis=1) / (known.conductivity * slope))
    return row


def _temperatures(fields, known):
    if known.times is None:
        return np.asarray(fields[0].temperature_at(known.positions))
    found = np.empty(len(known.times))
    for field, time in zip(fields, sorted(set(known.times.tolist())), strict=True):
        here = known.times == time
        found[here] = field.temperature_at(known.positions[here])
    return found


def related(relation, way) -> dict:
    """Solve a scene and one that a relation makes of it; the error is what the relation is broken by, in %."""
    table = benchmark.read(RELATED)
    changed, factor = globals()[f"_{relation}"](copy.deepcopy(table))
    answer, cost = measured(way, changed)
    # A uniform body conducts as its material does.
    other = 1.0 if relation == "uniform" else way(table).conductivity
    off = 100 * referee.value_error(answer.conductivity, factor * other)
    return {"conductivity": answer.conductivity, "error_percent": off, **cost, **answer.stats}


def _uniform(table):
    for material in table["scene"]["materials"]:
        material["conductivity"] = 1.0
    return table, 1.0


def _scaled(table):
    for material in table["scene"]["materials"]:
        material["conductivity"] *= FACTOR
    return table, FACTOR


def _reversed(table):
    walls = table["scene"]["walls"]
    table["scene"]["walls"] = dict(zip(walls, reversed(walls.values()), strict=True))
    return table, 1.0


def _turned(table):
    """What was along x is along y, and so on."""
    scene = table["scene"]
    scene["size"] = _next(scene["size"])
    for sphere in scene["inclusions"]:
        sphere["center"] = _next(sphere["center"])
    scene["walls"] = {AXES[(AXES.index(name[0]) + 1) % 3] + name[1]: load for name, load in scene["walls"].items()}
    return table, 1.0


def _tenfold(table):
    scene = table["scene"]
    scene["size"] = [10 * length for length in scene["size"]]
    for sphere in scene["inclusions"]:
        sphere["center"], sphere["radius"] = [10 * x for x in sphere["center"]], 10 * sphere["radius"]
    return table, 1.0


def _next(vector):
    return [vector[2], vector[0], vector[1]]
