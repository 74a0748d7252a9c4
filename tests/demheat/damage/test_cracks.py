"""Only here: cracks that cut other links than cross them, and arrays of them whose conductivity is known."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from test_removed_links import lattice, network

from demheat import Material, Scene, damage
from demheat.damage import Disc, Rectangle
from demheat.damage.cracks import PITCH, cracked, seamed
from demheat.network.base import Network, branches, row_numbers
from references.exact.cracks import discs

ONE = Material(1.0)
CELL = Scene((1.0, 1.0, 1.0), ONE, gradient=(0.0, 0.0, 1.0))


def crossing(made: Network, crack):
    """Links whose straight way meets one of 27 images of a crack, each looked at."""
    there = branches(made.centers, made.size, made.indptr, made.indices, made.image)
    start, found = made.centers[row_numbers(made.indptr)], np.zeros(len(there), bool)
    for shift in np.ndindex(3, 3, 3):
        a = start - np.array(crack.center) - (np.array(shift) - 1) * made.size
        ends = a @ crack.frame.T, (a + there) @ crack.frame.T
        through = ends[0][:, 2] * ends[1][:, 2] < 0
        part = (ends[0][:, 2] / np.where(through, ends[0][:, 2] - ends[1][:, 2], 1.0))[:, None]
        u, v, _ = (ends[0] + part * (ends[1] - ends[0])).T
        if isinstance(crack, Disc):
            found |= through & (np.hypot(u, v) <= crack.radius)
        else:
            found |= through & (np.abs(u) <= np.linalg.norm(crack.along)) & (np.abs(v) <= np.linalg.norm(crack.across))
    return found


@pytest.mark.parametrize(
    "crack",
    [
        Disc((0.5, 0.5, 0.52), 0.31, (0, 0, 1)),
        Disc((0.03, 0.9, 0.01), 0.4, (1, -2, 0.5)),
        Rectangle((0.13, 0.52, 0.97), (0.0, 0.33, 0.0), (0.2, 0.0, 0.11)),
    ],
)
def test_links_that_are_cut(crack):
    made = network(4)
    found = cracked(made, [crack])
    assert_array_equal(found.conductance == 0, (made.conductance == 0) | crossing(made, crack))
    assert not found.whole and np.count_nonzero(found.conductance == 0) > np.count_nonzero(made.conductance == 0)


def test_seams_are_mirrored_and_alone_beside_the_crack():
    disc = Disc((0.5, 0.5, 0.52), 0.2, (0, 0, 3))
    packing = lattice(10)
    made, radius = seamed(packing, [disc]), packing.radii.mean()
    away, flat = made.centers[:, 2] - 0.52, made.centers[:, :2] - 0.5
    # Nothing else is so near to the disc; the outermost pairs lie half a pitch outside of it.
    near = (np.abs(away) < 0.9 * radius) & (np.hypot(*flat.T) < 0.2 + 0.8 * PITCH * radius)
    assert np.sum(near) == made.provenance["seam"]
    assert_allclose(np.abs(away[near]), 0.5 * radius, rtol=1e-9)
    low, high = (flat[near & side] for side in (away < 0, away > 0))
    assert_allclose(low[np.lexsort(low.round(9).T)], high[np.lexsort(high.round(9).T)], atol=1e-12)
    # Squares as wide as the rings fill the disc, but for rounding of their numbers.
    inside, step = np.hypot(*low.T) < 0.2, 0.2 / round(0.2 / (PITCH * radius))
    assert_allclose(np.sum(inside) * step**2, math.pi * 0.2**2, rtol=0.03)


def test_an_array_of_discs():
    """The loss is too large by a part of a particle's size at the rim: first order, halved by eight times as many."""
    crack, sure = Disc((0.1, 0.9, 0.02), 0.25, (0, 0, -2)), 1 - discs(0.25).conductivity
    coarse, fine = (1 - damage.solve(CELL, cracks=[crack], particles=n).conductivity for n in (500, 4000))
    assert 0 < fine / sure - 1 < 0.16
    assert 0.3 < (fine - sure) / (coarse - sure) < 0.7


def test_an_array_of_slits():
    """Rows of slits, half a side wide: one row makes the way longer by 2 L/pi ln sec(pi a / L), rows far apart.

    By the map cosh(pi w / L) cos(pi a / L) = cosh(pi z / L); two sides apart the rows' influence is exp(-4 pi).
    """
    scene = Scene((1.0, 0.5, 2.0), ONE, gradient=(0.0, 0.0, 1.0))
    slit = Rectangle((0.5, 0.25, 1.0), (0.25, 0.0, 0.0), (0.0, 0.25, 0.0))
    more = 2 / math.pi * math.log(1 / math.cos(math.pi / 4))
    found = 2 / damage.solve(scene, cracks=[slit], particles=4000).conductivity - 2
    assert 0 < found / more - 1 < 0.15


def test_a_crack_through_the_body_stops_the_heat():
    sheet = Rectangle((0.5, 0.5, 0.4), (0.5, 0.0, 0.0), (0.0, 0.5, 0.0))
    for scene in (CELL, Scene((1.0, 1.0, 1.0), ONE, walls={"z-": 0.0, "z+": 1.0})):
        field = damage.solve(scene, cracks=[sheet], particles=500)
        assert field.conductivity == 0.0
    T = field.temperature_at(np.array([[0.5, 0.5, 0.2], [0.5, 0.5, 0.7]]))
    assert_allclose(T, [0.0, 1.0], atol=1e-12)


@pytest.mark.parametrize(
    "crack", [Disc((0.5, 0.5, 0.5), 1e-4, (0, 0, 1)), Rectangle((0.5, 0.5, 0.5), (0.3, 0.0, 0.0), (0.0, 1e-4, 0.0))]
)
def test_what_is_smaller_than_particles_is_said(crack):
    with pytest.warns(UserWarning, match=r"cracks \[0\] are small for particles of diameter"):
        found = damage.solve(CELL, cracks=[crack], particles=500)
    assert 0.9 < found.conductivity <= 1 + 1e-9
