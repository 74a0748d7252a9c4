"""Only here: closed forms of beds of grains off elimination, and our networks off these."""

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


def test_the_bed_at_random_hangs_together():
    """Each grain has heat from both ends: no temperature is undetermined, none is that of a wall."""
    bed = beds.BEDS["random bed, disc"].drawn()
    first, second, distance = beds.pairs(bed)
    assert np.all(np.bincount(np.concatenate((first, second)), minlength=len(bed.radii)) > 0)
    assert np.all(distance > np.abs(bed.radii[first] - bed.radii[second]))
    name = "random bed, disc"
    # Held grains are not quite of one temperature in our network: the square of 1e-4.
    assert_allclose(beds.solved(given.scene(name))["conductivity"], given.known(name), rtol=1e-7)
