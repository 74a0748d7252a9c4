"""Only here: named scenes of another size, fraction, gap or load than they are asked for."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from demheat import Layer, Material, gallery

PERIODIC_ONLY = (gallery.simple_cubic, gallery.body_centred, gallery.face_centred)
EITHER = (
    gallery.slab,
    gallery.laminate,
    gallery.sphere_in_cube,
    gallery.coated_sphere,
    gallery.random_dispersion,
)


@pytest.mark.parametrize("make", EITHER)
@pytest.mark.parametrize("axis", [0, 2])
def test_shared_load(make, axis):
    walled = make(periodic=False, axis=axis, temperatures=(300.0, 320.0))
    assert walled.wall_temperatures == {"xyz"[axis] + "-": 300.0, "xyz"[axis] + "+": 320.0}
    cell = make(periodic=True, axis=axis, temperatures=(300.0, 320.0))
    assert cell.periodic
    assert_allclose(np.array(cell.gradient) * cell.size, 20.0 * np.eye(3)[axis], rtol=1e-14)  # rounding


def test_haddad_cube():
    scene = gallery.sphere_in_cube()
    assert scene.size == (0.1, 0.1, 0.1)
    assert scene.walls == {"y-": 25.0, "y+": 35.0}
    assert_allclose(scene.conductivities, [33.0, 165.0], rtol=1e-14)
    assert_allclose(scene.inclusions[0].radius, 0.1 / 3, rtol=1e-14)
    assert_allclose(scene.inclusions[0].center, 0.05, rtol=1e-14)
    assert scene.matrix.density == scene.inclusions[0].material.density == 7800.0


@pytest.mark.parametrize(
    ("scene", "fraction"),
    [
        (gallery.sphere_in_cube(fraction=0.5, edge=2.0), 0.5),
        (gallery.simple_cubic(fraction=0.52), 0.52),
        (gallery.body_centred(fraction=0.68), 0.68),
        (gallery.face_centred(fraction=0.74), 0.74),
        (gallery.random_dispersion(7, fraction=0.1), 0.1),
    ],
)
def test_fractions(scene, fraction):
    volume = sum(4 / 3 * math.pi * sphere.radius**3 for sphere in scene.inclusions)
    assert_allclose(volume / scene.volume, fraction, rtol=1e-12)  # rounding


@pytest.mark.parametrize("make", PERIODIC_ONLY)
def test_arrays_touch_together(make):
    touching = {gallery.simple_cubic: math.pi / 6, gallery.body_centred: math.pi * math.sqrt(3) / 8}
    limit = touching.get(make, math.pi * math.sqrt(2) / 6)
    make(fraction=limit * (1 - 1e-9))
    with pytest.raises(ValueError, match=r"overlap partially|larger than the box"):
        make(fraction=limit * (1 + 1e-9))


def test_laminate_directions():
    across, along = (gallery.laminate(direction=d, axis=2, layers=3) for d in ("across", "along"))
    assert {layer.axis for layer in across.inclusions} == {2}
    assert {layer.axis for layer in along.inclusions} == {0}
    assert all(isinstance(layer, Layer) for layer in across.inclusions)
    assert_allclose(sum(layer.stop - layer.start for layer in across.inclusions), 0.05, rtol=1e-14)


@pytest.mark.parametrize(("core", "shell"), [(165.0, 16.5), (0.0, 2.0), (3.0, 0.0), (1.0, 1.0), (0.0, 0.0)])
def test_coated_sphere_is_neutral(core, shell):
    scene = gallery.coated_sphere(core, shell, core_fraction=0.3)
    assert_allclose((scene.inclusions[1].radius / scene.inclusions[0].radius) ** 3, 0.3, rtol=1e-14)
    total = core + 2 * shell
    beta = (core - shell) / total if total else 0.0
    assert_allclose(scene.matrix.conductivity, shell * (1 + 0.6 * beta) / (1 - 0.3 * beta), rtol=1e-14)


def test_dispersion_is_seeded():
    centers = [np.array([s.center for s in gallery.random_dispersion(seed=seed).inclusions]) for seed in (3, 3, 4)]
    assert_array_equal(centers[0], centers[1])
    assert np.abs(centers[0] - centers[2]).max() > 0.01
    # 0.2 * 6^3 * 6/pi = 82.5: the number of Haddad et al. (2021).
    assert len(centers[0]) == 83


@pytest.mark.parametrize(("ratio", "periodic"), [(1.0, True), (10.0, False)])
def test_dense_dispersion(ratio, periodic, tmp_path, monkeypatch):
    monkeypatch.setenv("DEMHEAT_CACHE", str(tmp_path))
    make = {"fraction": 0.4, "ratio": ratio, "periodic": periodic, "axis": 2, "edge": 2.0}
    scene = gallery.dispersion(120, seed=1, **make)
    centers, radii = (np.array([getattr(s, name) for s in scene.inclusions]) for name in ("center", "radius"))
    assert_allclose(4 / 3 * math.pi * np.sum(radii**3) / scene.volume, 0.4, rtol=1e-12)  # rounding
    assert_allclose(radii.max() / radii.min(), ratio, rtol=1e-12)
    assert_allclose(scene.conductivities[[0, -1]], [0.195, 1.5])
    offsets = centers[:, None] - centers
    offsets -= np.round(offsets / 2.0) * 2.0 if periodic else 0.0
    gaps = (np.linalg.norm(offsets, axis=2) - radii - radii[:, None])[np.triu_indices(120, 1)]
    least = 0.02 * 2 * np.cbrt(np.mean(radii**3))
    assert gaps.min() >= least - 1e-12  # rounding of coordinates up to 2
    if not periodic:
        assert np.min(np.minimum(centers, 2.0 - centers).min(axis=1) - radii) >= least - 1e-12
    one, other = ([s.center for s in gallery.dispersion(50, seed=seed, **make).inclusions] for seed in (1, 2))
    assert np.abs(np.subtract(one, other)).max() > 0.01


def test_a_material_scaled_without_end_is_a_perfect_conductor():
    assert gallery.scaled(gallery.HADDAD, math.inf).perfect
    tensor = Material(((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)))
    for wrong in (tensor, Material(0.0)):
        with pytest.raises(ValueError, match="contrast = inf"):
            gallery.scaled(wrong, math.inf)


def test_what_does_not_go_together():
    with pytest.raises(ValueError, match="give one of them"):
        gallery.sphere_in_cube(radius=0.01, fraction=0.1)
    with pytest.raises(ValueError, match="reaches at most 0.35"):
        gallery.random_dispersion(fraction=0.4, gap=0.0)
