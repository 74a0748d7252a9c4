"""What is true of each scene: closed forms, multipoles, or what two methods close in on, each with its doubt."""

import csv
import hashlib
import json
import math
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import references
from demheat.field import Field, Samples
from demheat.runtime.paths import replaced
from demheat.scene.volumes import fractions
from references.exact.squares import square_rods
from studies.common.searches import in_time
from studies.common.searches.scenes import FOR_LAWS, scene_of

# Conductivities of scenes that no closed form and no multipoles know: by two methods that close in on the same
# (`python -m studies.common.searches.by_two`).
FILE = Path(__file__).with_name("by_two.csv")
# Where fields are compared, at random, the same for every method.
POINTS, SEED = 200, 2027
# Relative error that multipoles are asked for, and how many times that their answer is taken to be off at most.
ACCURACY = {"5000 spheres": 1e-5, "3000 spheres": 1e-5, "1000 spheres": 1e-6, "unequal, f = .5": 1e-6}
USUAL, TIMES = 1e-7, 3.0
CLOSED = 1e-9
WITNESSES = ("exact", "multipole")


class Truth(NamedTuple):
    """What a scene conducts, W/(m K), by what part of that it may be off, and its field at points, if known."""

    conductivity: float
    off: float
    source: str
    points: np.ndarray
    field: Field | None = None


def truth_of(name: str) -> Truth:
    """What is true of a scene; of one that warms up its temperatures are (`in_time.exact_of`)."""
    if name in in_time.IN_TIME:
        in_time.exact_of(name)
        return Truth(math.nan, CLOSED, "series", in_time.points_of(name))
    if name in ("square rod", "image"):
        return Truth(square_rods(10.0) * scene_of(name).mean_conductivities[0], CLOSED, "Obnosov", points_of(name))
    known = _by_two()
    if name in known:
        row = known[name]
        return Truth(float(row["conductivity"]), float(row["off"]), f"{row['by']}, {row['and']}", points_of(name))
    found = _kept(name)
    # Laws are of the conductivity.
    field = None if name in FOR_LAWS else _field(name, found)
    return Truth(float(found["k"]), float(found["off"]), str(found["source"]), points_of(name), field)


def points_of(name: str) -> np.ndarray:
    """Points of a scene, (n, 3) float array, m, a hundredth of the box off its faces."""
    inside = 0.01 + 0.98 * np.random.default_rng(SEED).random((POINTS, 3))
    return inside * scene_of(name).size


@cache
def _by_two():
    with FILE.open(newline="", encoding="utf-8") as stream:
        return {row["scene"]: row for row in csv.DictReader(stream)}


def _field(name, found):
    scene, points = scene_of(name), points_of(name)
    volumes = np.full(len(points), scene.volume / len(points))
    samples = Samples(points, volumes, found["warm"], scene.phase_at(points), found["flux"])
    return Field(
        scene=scene,
        mean_flux=found["mean_flux"],
        fractions=fractions(scene),
        wall_temperature=scene.wall_temperatures,
        sampler=lambda: samples,
        temperature_at=lambda points: found["warm"],
        flux_at=lambda points: found["flux"],
        stats={"unknowns": 0, "iterations": 0, "residual": 0.0},
    )


def _worked_out(name):
    from references import exact, multipole

    scene, points = scene_of(name), points_of(name)
    try:
        field, off = exact.solve(scene), CLOSED
    except NotImplementedError:
        accuracy = ACCURACY.get(name, USUAL)
        field, off = multipole.solve(scene, accuracy=accuracy), TIMES * accuracy
    found = {"k": field.conductivity, "off": off, "source": field.stats.get("form", "multipoles")}
    found |= {"mean_flux": field.mean_flux, "warm": field.temperature_at(points), "flux": field.flux_at(points)}
    return found


def _kept(name):
    """The same from disk, where it is worked out once: it takes longer than most rows."""
    path = _file(name)
    if path.exists():
        with np.load(path) as stored:
            return dict(stored)
    found = _worked_out(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        np.savez(temporary, **found)
    return found


def _file(name):
    from demheat.packing.kept import cache_folder

    scene = scene_of(name)
    words = [repr(each) for each in (scene.size, scene.gradient, scene.walls, scene.matrix, scene.inclusions)]
    words += [POINTS, SEED, ACCURACY.get(name, USUAL), _source()]
    return Path(cache_folder()) / f"frontier-{hashlib.sha256(json.dumps(words).encode()).hexdigest()[:24]}.npz"


@cache
def _source():
    """Digest of the witnesses' source: what other code has worked out is not theirs."""
    home = Path(references.__path__[0])
    files = sorted(path for name in WITNESSES for path in (home / name).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()
