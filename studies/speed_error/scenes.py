"""The scenes of speed against error, and what is known of them exactly."""

from __future__ import annotations

import hashlib
import json
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

import references
from demheat.field import Field, Samples
from demheat.scene.volumes import fractions
from studies.common.steady_scenes import STEADY, TUNED  # noqa: F401 (known from here, too)

# Where fields are compared: at random, the same for every method.
POINTS, SEED = 400, 2026
# Relative error that multipoles are asked for, a hundredth of what the finest target asks of a method at most.
ACCURACY = {"1000 spheres": 1e-6}
USUAL_ACCURACY = 1e-7
WITNESSES = ("exact", "multipole")


def _slab():
    from studies.common.slab import slab

    return slab()


def _ball():
    from studies.common.sphere_in_time import sphere

    return sphere()


def _beam():
    from studies.common.terreros import beam

    return beam()


IN_TIME = {"slab": _slab, "ball": _ball, "beam": _beam}
# Bodies that tiles do not fit: their particles are packed.
ROUND = ("ball", "beam")
# Times at which temperatures are compared, s: those of the papers' figures.
TIMES = {"slab": (0.05, 0.1, 0.2), "ball": (1.0, 5.0, 10.0), "beam": (0.001, 0.01, 0.05, 0.1)}


@lru_cache(2)
def scene_of(name):
    """A scene by its name."""
    return (STEADY | IN_TIME)[name]()


@cache
def points_of(name):
    """Where its fields are compared, (n, 3) float array, m."""
    scene = scene_of(name)
    # Elements' chords leave a little of a round body out.
    inside = 0.98 * (np.random.default_rng(SEED).uniform(size=(4 * POINTS, 3)) - 0.5)
    for axes in {"box": (), "sphere": ((0, 1, 2),), "cylinder-x": ((1, 2),)}[scene.domain]:
        inside = inside[np.linalg.norm(inside[:, axes], axis=1) < 0.49]
    return (0.5 + inside[:POINTS]) * scene.size


@lru_cache(2)
def exact_of(name):
    """The exact steady field of a scene, known at its points and nowhere else.

    Closed forms, Rayleigh's method for the cubic array, multipoles for random spheres; those of spheres are kept on
    disk by scene and code, as they take longer than most rows.
    """
    found = _worked_out(name) if name == "laminate" else _kept(name)
    scene = scene_of(name)
    volumes = np.full(len(found["warm"]), scene.volume / len(found["warm"]))
    samples = Samples(points_of(name), volumes, found["warm"], scene.phase_at(points_of(name)), found["flux"])
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
        field = exact.solve(scene)
    except NotImplementedError:
        field = multipole.solve(scene, accuracy=ACCURACY.get(name, USUAL_ACCURACY))
    return {"mean_flux": field.mean_flux, "warm": field.temperature_at(points), "flux": field.flux_at(points)}


def _kept(name):
    path = _file(name)
    if path.exists():
        with np.load(path) as stored:
            return dict(stored)
    found = _worked_out(name)
    from demheat.runtime.paths import replaced

    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        np.savez(temporary, **found)
    return found


def _file(name):
    """Where the exact solution of a scene is kept: named by all that it hangs on."""
    from demheat.packing.kept import cache_folder

    scene = scene_of(name)
    spheres = [[*each.center, each.radius, each.material.conductivity] for each in scene.inclusions]
    words = [scene.matrix.conductivity, scene.size, scene.gradient, spheres, POINTS, SEED]
    words += [ACCURACY.get(name, USUAL_ACCURACY), _source()]
    key = hashlib.sha256(json.dumps(words).encode()).hexdigest()[:24]
    return Path(cache_folder()) / f"exact-{key}.npz"


@cache
def _source():
    """Digest of the witnesses' source: what other code has worked out is not theirs."""
    home = Path(references.__path__[0])
    files = sorted(path for name in WITNESSES for path in (home / name).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()
