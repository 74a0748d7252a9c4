"""Only here: bodies of a network with pores joined or parted wrongly, and ways around a period not seen."""

from types import SimpleNamespace

import numpy as np
import pytest
from bodies_by_hand import walk
from numpy.testing import assert_allclose, assert_array_equal
from random_links import each_link, random_links

import demheat
from demheat import Flux, Layer, Material, Scene
from demheat.conduction import components
from demheat.conduction import components_kernels as kernels
from demheat.network.base import image_shifts

PORE, ONE = Material(0.0), Material(1.0)


@pytest.mark.twin
@pytest.mark.parametrize("per_row, most", [(1, 7), (2, 1000), (3, 1)])
@pytest.mark.parametrize("jump", [(0.0, 0.0, 0.0), (1.0, -0.5, 2.0)])
def test_bodies_beside_those_found_by_hand(per_row, most, jump):
    links, places = random_links(60, per_row=per_row, seed=per_row)
    solid, jump = np.random.default_rng(1).random(60) > 0.2, np.array(jump)
    found = kernels.Found(
        np.where(solid, np.int32(kernels.OPEN), np.int32(kernels.NONE)),
        np.zeros((60, 3), np.int16),
        np.zeros(60, bool),
        np.empty(60, np.uint32),
    )
    state = np.zeros(4, np.int64)
    while kernels.gather(links, places.image, jump, found, state, most):
        pass
    step = image_shifts(places.image, np.ones(3)).astype(int)
    label, climbs = walk(solid, [(i, j, step[e]) for i, e, j, h in each_link(links) if h > 0], jump)
    assert_array_equal(found.label, label)
    assert_array_equal(found.climbs[: state[3]], climbs)
    # Every link joins two particles of a body at one place, or closes a way around.
    still = ~np.append(climbs, True)[label]
    for i, e, j, h in each_link(links):
        if h > 0 and solid[i] and solid[j] and still[i]:
            assert_allclose((found.shift[i] + step[e] - found.shift[j]) @ jump, 0, atol=1e-12)


@pytest.mark.twin
def test_means_of_bodies_are_taken_off():
    rng = np.random.default_rng(0)
    label, volumes, before = rng.integers(-1, 5, 200).astype(np.int32), rng.random(200), rng.random(200)
    # Bodies that are left out have no mass.
    label[label == 2] = -1
    after = before.copy()
    kernels.level_off(after, label, volumes, np.zeros(5), np.zeros(5))
    for body in range(-1, 5):
        here = label == body
        mean = np.average(before[here], weights=volumes[here]) if body >= 0 and here.any() else 0.0
        assert_allclose(after[here], before[here] - mean, atol=1e-14)  # rounding of sums
    again, nothing = before.copy(), np.full(200, -1, np.int32)
    components.level_off(again, label, volumes)
    assert_array_equal(again, after)
    components.level_off(again, nothing, volumes)
    assert_array_equal(again, after)


def layers(**load):
    """Metal from 0.2 to 0.5 and from 0.7 to 0.9."""
    return Scene((1, 1, 1), PORE, [Layer(1, 0.2, 0.5, ONE), Layer(1, 0.7, 0.9, ONE)], **load)


def test_nothing_is_looked_for_where_all_conducts(monkeypatch):
    monkeypatch.setattr(kernels, "gather", None)
    scene = Scene((1, 1, 1), ONE, [Layer(1, 0.2, 0.5, Material(1e-30))], gradient=(1.0, 0.0, 0.0))
    assert components.bodies(SimpleNamespace(whole=True), scene) is None


def test_a_solution_has_bodies_at_their_levels():
    field = demheat.solve(layers(gradient=(1.0, 2.0, 0.0)), particles=1500)
    own = field.samples
    for body, middle in ((1, 0.35), (2, 0.8)):
        here = own.phase == body
        rest = own.temperature - own.points @ (1.0, 2.0, 0.0)
        assert_allclose(np.average(rest[here], weights=own.volumes[here]), 0, atol=1e-12)  # rounding
        # Conforming particles: the middle of the layer, to the solver's tolerance.
        assert_allclose(field.temperature_at([[0.3, middle, 0.6]]), 0.3 + 2 * middle, atol=1e-5)
    assert_allclose(field.mean_flux, [-0.5, 0, 0], atol=1e-9)
    assert abs(field.heat_through(1, 0.35)) < 1e-8  # the solver's residual


def test_an_imposed_flux_passes_a_body_or_is_refused():
    walls = {"y-": 20.0, "y+": Flux(3.0)}
    pore = Scene((1, 1, 1), ONE, [Layer(1, 0.4, 0.6, PORE)], walls=walls)
    with pytest.raises(ValueError, match="cut off from every wall temperature"):
        demheat.solve(pore, particles=500)
    # Without heat the far body has no temperature, and neither has its wall.
    field = demheat.solve(Scene((1, 1, 1), ONE, pore.inclusions, walls={"y-": 20.0, "y+": Flux(0.0)}), particles=500)
    assert_array_equal(field.temperature_at([[0.5, 0.1, 0.5], [0.5, 0.9, 0.5]]), [20.0, np.nan])
    assert np.isnan(field.wall_temperature["y+"]) and field.wall_heat == {"y-": 0.0, "y+": 0.0}
