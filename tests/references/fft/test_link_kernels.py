"""Conduction through links beside differences of whole arrays."""

import numpy as np
import pytest
from fft_kernel_cases import chunks, padded
from numpy.testing import assert_allclose

from references.fft.hexahedron_kernels import Body, Sums
from references.fft.link_kernels import Links, conduct_links, link_state

pytestmark = pytest.mark.twin
SHAPE, SPACING, LOAD = (3, 4, 2), np.array([0.3, 0.2, 0.5]), np.array([0.3, -0.2, 0.5])


def solved(walls):
    """Links, temperatures, and by the definition: slope and flux along all links of an axis, that axis first."""
    rng = np.random.default_rng(1)
    theta, links, slopes, fluxes = rng.random(SHAPE), [], [], []
    for axis, h in enumerate(SPACING):
        t = np.moveaxis(theta, axis, 0)
        conductivity = rng.random((len(t) + 1, *t.shape[1:]))
        conductivity[-1] = conductivity[0]
        if walls and axis:
            conductivity[[0, -1]] = 0.0
        # An isothermal wall mirrors temperatures with their sign changed.
        ends = (-t[:1], -t[-1:]) if walls and not axis else (t[-1:], t[:1])
        slopes.append(np.diff(np.concatenate([ends[0], t, ends[1]]), axis=0) / h + LOAD[axis])
        fluxes.append(conductivity * slopes[-1])
        links.append(np.ascontiguousarray(np.moveaxis(conductivity, 0, axis)))
    return Body(Links(*links), 1 / SPACING, walls), theta, slopes, fluxes


def at_voxels(links, axis):
    """Mean over the two links of each voxel."""
    return np.moveaxis(0.5 * (links[1:] + links[:-1]), 0, axis)


@pytest.mark.parametrize("walls", [False, True])
def test_conduct_links(walls):
    body, theta, slopes, fluxes = solved(walls)
    work, sums = padded(np.full(SHAPE, np.nan)), Sums(np.full(SHAPE[0], np.nan), np.full((SHAPE[0], 3), np.nan))
    for low, high in chunks(SHAPE[0]):
        conduct_links(theta, work, body, LOAD, sums, low, high)
    divergence = sum(np.moveaxis(-np.diff(q, axis=0) / SPACING[a], 0, a) for a, q in enumerate(fluxes))
    energy = sum(at_voxels(q * g, a) for a, (q, g) in enumerate(zip(fluxes, slopes, strict=True)))
    # Rounding of sums of up to fifty numbers below 50.
    assert_allclose(work[..., : SHAPE[2]], divergence, atol=1e-12)
    assert_allclose(sums.energy, energy.sum(axis=(1, 2)), rtol=1e-13)
    expected = [at_voxels(q, a).sum(axis=(1, 2)) for a, q in enumerate(fluxes)]
    assert_allclose(sums.flux, np.transpose(expected), atol=1e-12)
    assert np.all(np.isnan(work[..., SHAPE[2] :]))


@pytest.mark.parametrize("walls", [False, True])
def test_link_state(walls):
    body, theta, _, fluxes = solved(walls)
    flux = np.full((3, *SHAPE), np.nan)
    for low, high in chunks(SHAPE[0]):
        link_state(theta, body, LOAD, flux, low, high)
    # Rounding of numbers below 10.
    assert_allclose(flux, [at_voxels(q, axis) for axis, q in enumerate(fluxes)], atol=1e-14)
