"""Only here: packings of replicas with seams, or walls that stand in particles."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import demheat
from demheat import Flux, Material, Scene, Sphere
from demheat.packing import domain
from demheat.packing.cache import replicated
from demheat.packing.domain import replica_counts, walled

LOADS = {"periodic": {"gradient": (1.0, 2.0, -0.5)}, "walls": {"walls": {"y-": 3.0, "y+": Flux(10.0)}}}


def test_counts():
    assert_array_equal(replica_counts(2_000_000, (1, 1, 1)), [1, 1, 1])
    assert_array_equal(replica_counts(8_000_000, (0.1, 0.1, 0.1)), [4, 4, 4])
    assert_array_equal(replica_counts(16_000, (1, 2, 1), 2), [2, 4, 2])
    for number, size in ((2_000_001, (1, 1, 1)), (9_000_000, (10, 1, 1)), (3_000_000, (1, 5, 0.01))):
        counts = replica_counts(number, size)
        assert number / counts.prod() <= domain.REPLICA
        assert np.all(np.array(size) / counts <= 1.0001 * np.cbrt(np.prod(size) * domain.REPLICA / number))


def test_too_many_replicas_are_named():
    with pytest.raises(ValueError, match="replicas = 2: makes 2 x 4 x 2 replicas .* need 16000 .* fewer for 10000"):
        replica_counts(10_000, (1, 2, 1), 2)
    with pytest.raises(ValueError, match="replicas = 1000000000000: makes"):
        replica_counts(10_000, (1, 2, 1), 10**12)


def test_what_replicas_are_not_for():
    walls = Scene(size=(1, 1, 1), matrix=Material(1.0), walls={"y-": 0.0, "y+": 1.0}, initial=0.0)
    with pytest.raises(NotImplementedError, match="only in boxes by 'laguerre'"):
        demheat.solve(walls, particles=10_000, replicas=2, law="calibrated")
    with pytest.raises(ValueError, match="of a packing that is given"):
        demheat.solve(walls, packing=replicated(1000, (1, 1, 1), periodic=False), replicas=2)
    with pytest.raises(NotImplementedError, match="only in boxes"):
        demheat.evolve(
            Scene(size=(1, 1, 1), matrix=Material(1.0, 1.0, 1.0), initial=0.0, domain="sphere", walls={"round": 1.0}),
            [1.0],
            replicas=2,
        )


def test_walls_keep_their_distance_and_order():
    packing = replicated(8000, (2, 2, 2), periodic=True)
    between = walled(packing)
    mean = packing.radii.mean()
    off = np.minimum(between.centers, 1.0 - between.centers)
    assert not between.periodic.any()
    assert mean * (1 - 1e-12) <= off.min() < 1.05 * mean
    moved = between.centers != packing.centers
    depth = domain.DRAWN[1] * mean
    assert_array_equal(moved, np.minimum(packing.centers, 1.0 - packing.centers) < depth)
    for k in range(3):
        order = np.argsort(packing.centers[:, k])
        assert np.all(np.diff(between.centers[order, k]) >= 0)


@pytest.mark.filterwarnings("ignore:replicas = :DeprecationWarning")
@pytest.mark.parametrize("load", LOADS)
def test_linear_fields_are_exact_on_replicas(load):
    same = [Sphere((0.5,) * 3, 0.3, Material(5.0))]
    scene = Scene(size=(1, 2, 1), matrix=Material(5.0), inclusions=same, **LOADS[load])
    field = demheat.solve(scene, particles=16_000, replicas=2, tolerance=1e-13)
    gradient = np.array((1.0, 2.0, -0.5) if load == "periodic" else (0.0, 2.0, 0.0))
    samples = field.samples
    # tolerance 1e-13 of the heat passing, times n^(2/3) for the condition
    assert_allclose(field.conductivity, 5.0, rtol=1e-10)
    assert_allclose(samples.flux, np.tile(-5.0 * gradient, (len(samples.flux), 1)), atol=1e-8)
    assert_allclose(samples.volumes.sum(), 2.0, rtol=1e-12)
    assert field.stats["packing"]["repeats"] == [2, 4, 2] and field.stats["cached"] in (True, False)
    # Twins come on top of the 16 000; a few particles at the sphere give way.
    assert 15_000 < field.stats["unknowns"] - field.stats["packing"]["twins"] < 16_000
