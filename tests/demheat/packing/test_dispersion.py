"""Only here: random dispersions whose fraction, least gap or crowding is not what was asked for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import cKDTree

from demheat.packing import dispersion as module
from demheat.packing.dispersion import dispersion, dispersion_scene
from demheat.packing.radii import Bidisperse, Gaussian
from demheat.scene import Material

EPOXY, SILICA = Material(0.195), Material(1.5)


def mean_diameter(radii):
    return 2 * np.cbrt(np.mean(radii**3))


def least_gap(centers, radii, size, periodic):
    """Smallest surface distance of two spheres, and of a sphere and a wall, in diameters of the mean volume."""
    size = np.array(size, dtype=float)
    inside = centers % size if periodic else centers
    tree = cKDTree(inside, boxsize=size if periodic else None)
    i, j = tree.query_pairs(2.5 * radii.max(), output_type="ndarray").T
    offsets = centers[i] - centers[j]
    if periodic:
        offsets -= size * np.rint(offsets / size)
    between = np.min(np.linalg.norm(offsets, axis=1) - radii[i] - radii[j], initial=np.inf)
    walls = np.minimum(centers, size - centers).min(axis=1) - radii
    return between / mean_diameter(radii), walls.min() / mean_diameter(radii)


def filled(radii, size=(1.0, 1.0, 1.0)):
    return 4 / 3 * np.pi * np.sum(radii**3) / np.prod(size)


CASES = [
    {"fraction": 0.1},
    {"fraction": 0.5},
    {"fraction": 0.5, "periodic": False},
    {"fraction": 0.3, "method": "rsa"},
    {"fraction": 0.2, "method": "rsa", "periodic": False, "ratio": 8.0},
    {"fraction": 0.4, "radii": Gaussian(0.3), "gap": 0.03},
    {"fraction": 0.3, "radii": Bidisperse(2.0, 0.3), "periodic": False, "size": (2e-3, 1e-3, 1.5e-3), "ratio": 5.0},
    {"fraction": 0.25, "radii": Gaussian(0.2), "method": "rsa", "size": (1.0, 2.0, 1.0), "ratio": 5.0},
    {"fraction": 0.2, "gap": 0.0, "number": 30},
    {"fraction": 0.05, "number": 1, "method": "rsa", "periodic": False},
]


@pytest.mark.parametrize("knobs", CASES)
def test_fraction_and_gaps(knobs):
    size, periodic, gap = knobs.get("size", (1.0,) * 3), knobs.get("periodic", True), knobs.get("gap", 0.02)
    centers, radii = dispersion(seed=1, **knobs)
    assert centers.shape == (len(radii), 3)
    # Rounding of a sum over some hundred spheres.
    assert_allclose(filled(radii, size), knobs["fraction"], rtol=1e-14)
    between, walls = least_gap(centers, radii, size, periodic)
    # Rounding of coordinates, in diameters.
    assert between >= gap - 1e-11
    assert periodic or walls >= gap - 1e-11
    if periodic:
        assert np.all((centers >= 0) & (centers <= size))
        # Cells of 30 spheres and more: some cross the faces.
        assert walls < 0
    if "radii" not in knobs:
        assert_allclose(radii, radii[0], rtol=1e-12)  # taken off what was added: rounding
    if "number" not in knobs:
        # N is rounded to a whole number: for 24 spheres and more, half of one changes L/D by a 150th at most.
        assert_allclose(min(size) / mean_diameter(radii), knobs.get("ratio", 6.0), rtol=1 / 140)


def test_gaps_are_as_small_as_asked():
    # At f = 0.5 spheres collide until the end, so that some are almost at the least distance: not pushed apart by more.
    between, _ = least_gap(*dispersion(fraction=0.5, seed=1), (1, 1, 1), True)
    assert between < 0.021
    _, walls = least_gap(*dispersion(fraction=0.5, seed=1, periodic=False), (1, 1, 1), False)
    assert walls < 0.021


@pytest.mark.parametrize("method", ["lsa", "rsa"])
def test_seeds(method, tmp_path):
    def made(seed, folder):
        return dispersion(30, fraction=0.2, method=method, seed=seed, folder=tmp_path / folder)

    first, again, other = made(3, "a"), made(3, "b"), made(4, "a")
    for one, two in zip(first, again, strict=True):
        assert_array_equal(one, two)  # made twice, in two folders
    assert abs(first[0] - other[0]).max() > 0.1
    assert len(list((tmp_path / "a").iterdir())) == 2 and len(list((tmp_path / "b").iterdir())) == 1


def test_kept_and_scaled(tmp_path, monkeypatch):
    small = dispersion(fraction=0.2, size=(0.1, 0.1, 0.2), folder=tmp_path)
    monkeypatch.setattr(module, "lsa", None)  # nothing is made a second time
    large = dispersion(fraction=0.2, size=(0.3, 0.3, 0.6), folder=tmp_path)
    assert_allclose(large[0], 3 * small[0], rtol=1e-14, atol=1e-15)
    assert_allclose(large[1], 3 * small[1], rtol=1e-14)
    for knobs in ({"gap": 0.03}, {"seed": 1}, {"periodic": False}, {"radii": Gaussian(0.1)}, {"ratio": 5}):
        with pytest.raises(TypeError, match="not callable"):  # other spheres are not taken for these
            dispersion(**{"fraction": 0.2, "size": (0.1, 0.1, 0.2), "folder": tmp_path} | knobs)


def close_pairs():
    """Mean number of spheres within 1.3 diameters of another, over some dispersions without a gap."""
    found = []
    for seed in range(3):
        centers, radii = dispersion(fraction=0.3, ratio=8.0, gap=0.0, seed=seed)
        pairs = cKDTree(centers, boxsize=1 + 1e-12).query_pairs(1.3 * mean_diameter(radii))
        found.append(2 * len(pairs) / len(radii))
    return np.mean(found)


def test_neighbours_as_in_equilibrium():
    # Percus and Yevick's fluid at f = 0.3, by inversion of its structure factor, has 4.82, good to some 2 %; centres
    # that only keep off each other would have 2.9. The mean of 3 cells of 293 spheres scatters by 0.05.
    assert_allclose(close_pairs(), 4.82, atol=0.2)


def test_scene():
    scene = dispersion_scene(
        40, fraction=0.15, matrix=EPOXY, inclusion=SILICA, size=(0.2, 0.1, 0.1), axis=0, temperatures=(20.0, 30.0)
    )
    centers, radii = dispersion(40, fraction=0.15, size=(0.2, 0.1, 0.1))
    assert_allclose(scene.gradient, (50.0, 0.0, 0.0), rtol=1e-14)
    assert_array_equal([sphere.center for sphere in scene.inclusions], centers)
    assert_array_equal([sphere.radius for sphere in scene.inclusions], radii)
    assert scene.matrix == EPOXY and scene.materials[1:] == (SILICA,) * 40


def test_the_same_spheres_under_both_loads():
    knobs = {"fraction": 0.4, "periodic": False, "matrix": EPOXY, "inclusion": SILICA}
    walls, cell = (dispersion_scene(load=load, **knobs) for load in (None, "gradient"))
    assert walls.inclusions == cell.inclusions and not walls.periodic and cell.periodic
    assert walls.walls == {"y-": 25.0, "y+": 35.0}
    assert_allclose(cell.gradient, (0.0, 10.0, 0.0), rtol=1e-15)
    # Nothing is cut by a wall, and no sphere has a second image.
    assert len(cell.images()) == len(cell.inclusions) == 165


@pytest.mark.parametrize(
    ("knobs", "match"),
    [
        ({"fraction": 0.62}, "fill 0.658 of the box; must be <= 0.63 by 'lsa'"),
        ({"fraction": 0.31, "method": "rsa"}, "fraction = 0.31: must be <= 0.3 by 'rsa'"),
        ({"fraction": 0.3, "method": "rsa", "gap": 0.06}, "fill 0.357 of the box; must be <= 0.35 by 'rsa'"),
        ({"number": 83, "ratio": 6.0}, "number = 83, ratio = 6.0: one gives the other"),
        ({"ratio": 1.0}, "ratio = 1.0: must be a finite number > 1"),
        ({"periodic": (True, True, False)}, "periodic = .*must be True or False"),
        ({"radii": [1.0, 2.0]}, "2 radii for 83 particles"),
        ({"number": 1, "fraction": 0.6, "gap": 0.0, "method": "lsa", "periodic": False}, "must fit"),
        ({"number": 1}, "number = 1: must be an integer >= 2 by 'lsa', .*method='rsa'"),
        ({"number": 2}, "number = 2, fraction = 0.2, gap = 0.02: .*more spheres, a smaller fraction, or method='rsa'"),
        ({"number": 3}, "number = 3, fraction = 0.2, gap = 0.02: .*must be >= 2.1 diameters"),
        ({"number": 2, "fraction": 0.5, "gap": 0.0}, "number = 2, fraction = 0.5, gap = 0.0: "),
        ({"number": 100_001}, "number = 100001: must be <= 100000"),
        ({"ratio": 1e6}, r"ratio = 1000000.0 at fraction = 0.2 .*: makes 3.82e\+17 spheres; must be <= 100000"),
        ({"size": (1, 1, 1e-4)}, "ratio = 6.0 at .*; must be <= 100000"),
    ],
)
def test_bad_arguments(knobs, match, tmp_path):
    with pytest.raises(ValueError, match=match):
        dispersion(folder=tmp_path, **knobs)
    assert not list(tmp_path.iterdir())


def test_few_spheres_that_fit():
    # Just above what is refused: 3 spheres by either method, and 1 by the one that makes no collisions.
    assert len(dispersion(3, fraction=0.1)[1]) == len(dispersion(3, fraction=0.2, method="rsa")[1]) == 3
    assert len(dispersion(1, fraction=0.2, method="rsa")[1]) == 1
    _, radii = dispersion(fraction=0.2, number=4, radii=[1.0, 2.0, 1.0, 2.0], method="rsa", gap=0.01)
    assert_allclose(np.sort(radii / radii.min()), [1, 1, 2, 2], rtol=1e-12)


@pytest.mark.parametrize(
    ("knobs", "match"),
    [
        ({"axis": 3}, "axis = 3: must be"),
        ({"temperatures": (1.0, 1.0)}, "temperatures = "),
        ({"load": "walls"}, "load = 'walls' with periodic = True"),
    ],
)
def test_bad_loads_are_refused_before_spheres_are_placed(knobs, match, monkeypatch):
    monkeypatch.setattr(module, "dispersion", None)
    with pytest.raises(ValueError, match=match):
        dispersion_scene(matrix=EPOXY, inclusion=SILICA, **knobs)


def test_no_room_is_said(monkeypatch):
    monkeypatch.setattr("demheat.addition.TRIALS", 2560)
    with pytest.raises(RuntimeError, match="no room for sphere .* in 2560 trials"):
        dispersion(fraction=0.3, method="rsa", periodic=False, ratio=4.0)
