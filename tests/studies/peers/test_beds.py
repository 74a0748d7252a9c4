"""Beds of grains: closed forms against elimination and against our networks."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from studies.peers import beds, given

CLOSED = [name for name in beds.BEDS if not name.startswith("random")]


@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms(name):
    """What is printed on paper is what the full matrix says: rounding of some hundred sums."""
    assert_allclose(beds.eliminated(beds.BEDS[name].drawn()), beds.known(name), rtol=1e-12)


@pytest.mark.parametrize("law", beds.LAWS)
@pytest.mark.parametrize("arrangement", ["unlike chain", "simple cubic", "body-centred"])
def test_our_networks_know_them(arrangement, law):
    """Our solver stops at 1e-10 of the right-hand side."""
    scene = beds.BEDS[f"{arrangement}, {law}"]
    assert_allclose(beds.solved(scene)["conductivity"], beds.known(f"{arrangement}, {law}"), rtol=1e-9)


@pytest.mark.parametrize("arrangement", ["simple cubic", "body-centred"])
def test_lattices_of_any_length(arrangement):
    scene = beds.BEDS[f"{arrangement}, disc"]
    assert_allclose(beds.eliminated(scene.drawn(3)), beds.eliminated(scene.drawn(7)), rtol=1e-12)


def test_the_bed_at_random_hangs_together():
    """Each grain has heat from both ends: no temperature is undetermined, none is that of a wall."""
    bed = beds.BEDS["random bed, disc"].drawn()
    first, second, distance = beds.pairs(bed)
    assert np.all(np.bincount(np.concatenate((first, second)), minlength=len(bed.radii)) > 0)
    assert np.all(distance > np.abs(bed.radii[first] - bed.radii[second]))
    name = "random bed, disc"
    # Held grains are not quite of one temperature in our network: the square of 1e-4.
    assert_allclose(beds.solved(given.scene(name))["conductivity"], given.known(name), rtol=1e-7)


def test_laws_beside_a_disc():
    """Two equal grains: the root of the area is sqrt(pi) radii, Hertz's circle smaller than that of the cut."""
    chain = {law: beds.known(f"chain, {law}") for law in beds.LAWS}
    assert_allclose(chain["root of area"] / chain["disc"], np.sqrt(np.pi), rtol=1e-12)
    # a^2 = R delta against a^2 = r^2 - d^2/4 with R = r/2, d = 2 r - delta: half of it for little overlap.
    assert 0.7 < chain["Hertz radius"] / chain["disc"] < 0.72


def test_steps_reach_the_steady_state():
    bed = beds.BEDS["unlike chain, disc"].drawn(5)
    step, count = beds.march(bed)
    first, second, conductance = beds.conductances(bed)
    stored = beds.STORED * 4 / 3 * np.pi * bed.radii**3
    free, warmth = np.isnan(bed.held), np.nan_to_num(bed.held)
    for _ in range(count):
        flow = conductance * (warmth[second] - warmth[first])
        received = np.bincount(first, flow, 5) - np.bincount(second, flow, 5)
        warmth = warmth + np.where(free, step * received / stored, 0.0)
    assert_allclose(bed.conductivity(-received[bed.held == 1.0][0]), beds.eliminated(bed), rtol=1e-9)
