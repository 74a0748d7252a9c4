"""Only here: inclusions left out that lose more than is told."""

import numpy as np
import pytest

from demheat import Layer, Material, Scene, Sphere, gallery
from demheat.scene import Ellipsoid
from demheat.scene.negligible import change_without, negligible
from demheat.tensor import conductivity_tensor
from references import exact, multipole
from references.exact.ellipsoids import maxwell

MATRIX, BEST, PORE = Material(1.0), Material(1e6), Material(0.0)


def cell(*inclusions, **load):
    return Scene((1.0, 1.0, 1.0), MATRIX, inclusions, **(load or {"gradient": (0.0, 1.0, 0.0)}))


def changes(scene, without):
    """Relative changes of the diagonal of the tensor, by multipoles of 12 degrees: the tiny spheres need fewer."""
    whole, less = (np.diag(conductivity_tensor(multipole.solve_axes(each, order=12))) for each in (scene, without))
    return np.abs(whole / less - 1)


def scattered(material, radius, seed=0, count=12):
    """A sphere of a third of the edge, and tiny ones of a material where there is room."""
    random, tiny = np.random.default_rng(seed), []
    while len(tiny) < count:
        place = random.random(3)
        near = [np.linalg.norm((place - other.center + 0.5) % 1 - 0.5) for other in tiny]
        beside = np.linalg.norm(place - 0.5) - 0.3
        if abs(beside) > 4 * radius and min(near, default=1.0) > 8 * radius:
            tiny.append(Sphere(tuple(place), radius, material)) if beside > 0 else None
    return [Sphere((0.5, 0.5, 0.5), 0.3, Material(50.0)), *tiny]


@pytest.mark.parametrize(("material", "seed"), [(BEST, 0), (PORE, 1), (Material(2.0), 2)])
def test_no_more_is_lost_than_told(material, seed):
    scene = cell(*scattered(material, 0.008, seed))
    found = negligible(scene, 0.1)
    assert 0 < len(found.inclusions) and 0 not in found.inclusions and 0 < found.bound <= 0.1
    lost = changes(scene, found.scene)
    # Degrees beyond 12 are below 1e-7 here, and what is lost well above.
    assert np.all(lost <= found.bound) and lost.max() > 1e-7


def test_in_the_hottest_place():
    """A good sphere between two others nearly in touch, where the gradient is many times the mean."""
    pair = [Sphere((0.5, 0.5 + sign * 0.21, 0.5), 0.2, BEST) for sign in (-1, 1)]
    scene = cell(*pair, Sphere((0.5, 0.5, 0.5), 0.002, BEST))
    f = 4 / 3 * np.pi * 0.002**3
    lost = changes(scene, cell(*pair))[1]
    # Far more than Maxwell's polarisability in the mean gradient tells: that would be no bound.
    assert lost > 10 * 3 * f
    told = negligible(scene, 0.5)
    assert told.inclusions == (2,) and lost <= told.bound
    assert negligible(scene, 10 * f).inclusions == ()


def test_what_matters_or_is_not_known_stays():
    tiny = Sphere((0.25, 0.25, 0.25), 1e-3, BEST)
    assert negligible(cell(tiny), 1e-3).inclusions == (0,)
    assert negligible(cell(tiny), 1e-9).inclusions == ()
    assert negligible(gallery.simple_cubic(), 0.1).inclusions == ()
    assert negligible(cell(), 0.1) == ((), 0.0, cell())
    # Cut by a wall, in a pore, around another, in a layer too thin, touching: all are left in.
    assert negligible(cell(Sphere((0.0, 0.25, 0.25), 1e-3, BEST), walls={"y-": 0.0, "y+": 1.0}), 1e-3).inclusions == ()
    assert (
        negligible(cell(Sphere((0.5, 0.5, 0.5), 0.3, PORE), Sphere((0.5, 0.5, 0.5), 1e-3, BEST)), 0.1).inclusions == ()
    )
    # What is known of a pore in it is the energy of all of the tiny sphere, little as that is.
    nested = cell(tiny, Sphere((0.25, 0.25, 0.25), 5e-4, PORE))
    assert negligible(nested, 1e-3).inclusions == () and negligible(nested, 0.5).inclusions == (1,)
    assert negligible(cell(Layer(0, 0.2485, 0.2515, PORE)), 0.1).inclusions == ()
    assert negligible(cell(Layer(0, 0.2485, 0.2515, MATRIX), tiny), 0.1).inclusions == ()
    touching = Sphere((0.252, 0.25, 0.25), 1e-3, BEST)
    assert negligible(cell(tiny, touching), 1e-3).inclusions == ()
    # One of a pair stays, and the other is far from the rest.
    assert negligible(cell(tiny, touching, Sphere((0.75, 0.75, 0.75), 1e-3, BEST)), 1e-3).inclusions == (2,)


@pytest.mark.parametrize("material", [BEST, PORE])
@pytest.mark.parametrize("axes", [(0.1, 0.01, 0.01), (0.1, 0.1, 0.01)])
def test_what_is_no_sphere_changes_no_more_than_the_ball_about_it(material, axes):
    slender = cell(Ellipsoid((0.5, 0.5, 0.5), axes, material), gradient=(1.0, 0.0, 0.0))
    ball = cell(Sphere((0.5, 0.5, 0.5), 0.1, material), gradient=(1.0, 0.0, 0.0))
    # Maxwell's estimate of few, to the first order of their volume of a thousandth or so.
    share = 4 / 3 * np.pi * np.prod(axes)
    lost = abs(maxwell(material.conductivity, axes, share)[0, 0] - 1)
    assert 0 < lost < change_without(slender, [0]) == change_without(ball, [0])
    assert negligible(slender, 0.1).inclusions == (0,)
    beside = Sphere((0.5, 0.5, 0.56), 0.01, BEST)  # within the ball
    assert change_without(cell(*slender.inclusions, beside), [0]) == np.inf


def test_all_of_a_material_stay_as_one_limit():
    """Many together may matter where each does not."""
    places = (np.indices((8, 8, 8)).reshape(3, -1).T + 0.5) / 8
    many = [Sphere(tuple(place), 0.01, BEST) for place in places]
    one = negligible(cell(many[0]), 1e-3)
    assert one.inclusions == (0,) and negligible(cell(*many), 1e-3).inclusions == ()
    told = negligible(cell(*many), 0.9)
    lost = exact.solve(gallery.simple_cubic(1e6, fraction=512 * 4 / 3 * np.pi * 1e-6)).conductivity / 33.0 - 1
    assert len(told.inclusions) == 512 and 0 < lost <= told.bound
