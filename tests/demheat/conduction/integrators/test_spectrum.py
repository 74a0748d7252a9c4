"""Only here: a spectral radius below the true one, which makes explicit steps unstable."""

import numpy as np
import pytest
from small_networks import KINDS, dense, network_of, system_of

from demheat.conduction.integrators import spectrum as module
from demheat.conduction.integrators.spectrum import spectrum
from demheat.conduction.integrators.system import System
from demheat.conduction.integrators.transient_kernels import Ties
from demheat.network.links_kernels import Links


def largest(system):
    """Largest eigenvalue of C^-1 A by a dense solver."""
    free = system.capacity > 0
    root = np.sqrt(system.capacity[free])
    return np.linalg.eigvalsh(dense(system)[np.ix_(free, free)] / root[:, None] / root)[-1]


# Found above the true one: 0.27, 14 and 0.014 %. Small spheres that touch among large ones are fast together.
@pytest.mark.parametrize(("kind", "slack"), [("laguerre", 0.003), ("ten", 0.15), ("calibrated", 3e-4)])
def test_radius_is_never_below_the_true_one_and_tight(kind, slack):
    found, true = spectrum(system_of(kind)), largest(system_of(kind))
    assert true <= found.radius <= (1 + slack) * true
    assert true <= found.rows <= 2 * true * (1 + 1e-10)  # the largest row alone is a lower bound; rounding
    assert found.limit == 2 / found.radius
    assert found.positivity <= 2 / true * (1 + 1e-10)
    # A bound after every pass: also where iterations end long before it settles.
    assert spectrum(system_of(kind), tolerance=0.9).radius >= true


def test_networks_are_what_they_are_called():
    volumes = network_of("ten").volumes
    assert 8 < np.cbrt(volumes.max() / volumes.min()) < 12  # cells of spheres with ratio 10 differ a little less
    links = np.diff(network_of("calibrated").indptr)
    assert np.sum(links == 2) > 10


@pytest.mark.parametrize("passes", [1, 3])
def test_a_bound_after_any_number_of_passes(monkeypatch, passes):
    monkeypatch.setattr(module, "MOST", passes)
    for kind in KINDS:
        found = spectrum(system_of(kind))
        assert found.iterations == passes and largest(system_of(kind)) <= found.radius <= found.rows * (1 + 1e-11)


def chain(n):
    """Balance of n cells of unit capacity in a row, unit conductances between them, nothing held."""
    rows = [[j for j in (i - 1, i + 1) if 0 <= j < n] for i in range(n)]
    count = np.array([len(row) for row in rows])
    links = np.concatenate([[0], np.cumsum(count)]), np.concatenate(rows).astype(np.uint32), np.ones(count.sum())
    none = np.empty(0, dtype=np.int64)
    return System(
        links=Links(*links),
        capacity=np.ones(n),
        inverse=np.ones(n),
        diagonal=count.astype(float),
        held=none,
        ties=Ties(none, none, np.empty(0), none),
        held_at=None,
        heat_at=None,
        level=0.0,
        particles=n,
    )


def test_cells_in_a_row():
    """Eigenvalues 4 cos^2(pi/2n), the first of rings without an odd one: absolute values change nothing."""
    # No less for rounding: it is a bound.
    assert 2.0 <= spectrum(chain(2)).radius == pytest.approx(2.0, rel=1e-11)
    # The bound comes down from the rows' 4 as slowly as a long wave spreads.
    assert 4 * np.cos(np.pi / 80) ** 2 <= spectrum(chain(40)).radius <= 4.0 * (1 + 1e-11)
    assert spectrum(chain(4), tolerance=0.0).radius == pytest.approx(4 * np.cos(np.pi / 8) ** 2, rel=1e-6)


def test_no_exchange_of_heat_is_no_limit():
    system = system_of("laguerre")
    untied = system.ties._replace(conductance=np.zeros(len(system.ties.row)))
    still = system._replace(diagonal=np.zeros_like(system.diagonal), ties=untied)
    found = spectrum(still)
    assert found.radius == 0 and found.limit == np.inf
