"""Columns of twins between parallel surfaces, whatever is between them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Box, Layer, Material, Scene, Sphere, gallery, solve
from demheat.network.base import row_numbers
from demheat.network.laguerre import laguerre
from demheat.packing.tile import tiled
from demheat.packing.twins.conforming import OFFSET, conform
from demheat.packing.twins.gaps import Interfaces
from demheat.packing.twins.interfaces import pattern_count
from demheat.packing.twins.stacks import BENT, SHARE
from references import exact

MATRIX, OTHER = Material(1.0), Material(10.0)


def scene(*inclusions, axis=1, periodic=True):
    return Scene((1.0,) * 3, MATRIX, inclusions, **gallery.loaded((1.0,) * 3, axis=axis, periodic=periodic))


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("thickness, k", [(1e-2, 1e3), (1e-4, 1e-3), (1e-5, 1e4)])
def test_layers_of_any_thickness_are_exact(thickness, k, axis, periodic):
    """Across them and along them, by as many twins as two planes have that are far from each other."""
    field = solve(scene(Layer(2, 0.3, 0.3 + thickness, Material(k)), axis=axis, periodic=periodic), particles=1000)
    series, parallel = 1 / (1 - thickness + thickness / k), 1 - thickness + thickness * k
    # What the solver leaves: its tolerance is 1e-8 of the heat balance.
    assert_allclose(field.conductivity, series if axis == 2 else parallel, rtol=1e-7)
    far = solve(scene(Layer(2, 0.2, 0.7, Material(k)), axis=axis, periodic=periodic), particles=1000)
    assert field.stats["packing"]["twins"] == far.stats["packing"]["twins"] > 500
    assert field.stats["packing"]["pairs_left_out"] == 0


def test_layers_beside_a_wall_and_each_other_are_one_stack():
    """A wall is a mirror: cells between it and a plane are prisms, too."""
    layers = [Layer(2, 2e-3, 5e-3, Material(1e3)), Layer(2, 6e-3, 0.5, Material(7.0)), Layer(2, 0.99, 0.999, OTHER)]
    field = solve(scene(*layers, axis=2, periodic=False), particles=1000)
    assert_allclose(field.conductivity, exact.solve(field.scene).conductivity, rtol=1e-7)  # the solver's tolerance
    assert field.stats["packing"]["pairs_left_out"] == 0


@pytest.mark.parametrize("number", [1000, 8000])
@pytest.mark.parametrize("core, shell, inner", [(2e-3, 380.0, 0.93), (5.0, 0.5, 0.95), (0.1, 30.0, 0.995)])
def test_coats_have_the_twins_of_two_spheres(core, shell, inner, number):
    coated = gallery.coated_sphere(core, shell, radius=0.35, core_fraction=inner**3, edge=1.0)
    field = solve(coated, particles=number)
    # What is left is of the fourth power of width over radius, or, with one twin for both, of the square of .0025.
    assert_allclose(field.conductivity, exact.solve(coated).conductivity, rtol=1e-5)
    share = SHARE if inner < 0.98 else inner / (1 + inner)
    columns = pattern_count(0.35, min(1.6 * radius_of(field), 0.35 * np.sqrt(BENT * share * (1 - inner))))
    assert field.stats["packing"]["twins"] == 4 * columns


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_where_two_twins_of_a_shell_stand(degree):
    """One column of a thin shell, with the field r^-(degree + 1) as it begins: what goes wrong crosses 0 by the share.

    Any field of degree 1 is a linear one, which is exact, and this; fluxes are symmetric, so it is off by this with
    itself alone.
    """

    def off(share, half=0.01):
        places = [1 - half, 1 - half + 2 * half * share, 1.0, 1 + half - 2 * half * share, 1 + half]
        there, flux = places[0] ** -(degree + 1), -(degree + 1) * places[0] ** -degree
        for below, site, above in (places[:3], places[2:]):
            there += flux * (site - below) / below**2
            flux += degree * (degree + 1) * there * (above**2 - below**2) / (2 * site)
            there += flux * (above - site) / above**2
        right = places[-1] ** -(degree + 1), -(degree + 1) * places[-1] ** -degree
        return right[0] * (flux - right[1]) - right[1] * (there - right[0])

    # A seventh of what a sixth or a quarter leaves; for degree 1 a hundredth and less.
    assert abs(off(SHARE)) < 0.15 * min(abs(off(1 / 6)), abs(off(1 / 4)))
    assert off(1 / 6) * off(1 / 4) < 0


def radius_of(field):
    """Mean radius of the particles of a field, m."""
    made = field.stats["packing"]
    return (0.75 / np.pi * made["phi"] / made["number"]) ** (1 / 3)


@pytest.mark.parametrize("inner", [0.34, 0.349, 0.3495])
def test_facets_of_a_coat_lie_on_its_spheres(inner):
    """Each twin meets one particle of another phase: its partner. So no facet crosses, and volumes are right."""
    given = scene(Sphere((0.4, 0.5, 0.6), 0.35, OTHER), Sphere((0.4, 0.5, 0.6), inner, MATRIX))
    packing = conform(tiled(1500, size=(1.0,) * 3), given)
    facets = laguerre(packing.centers, packing.radii**2, packing.size)
    phase, row = given.phase_at(packing.centers), row_numbers(facets.indptr)
    # Facets that rounding makes where four or more twins meet in one point are left out.
    across = (phase[row] != phase[facets.indices]) & (facets.area > 1e-9 * facets.area.max())
    assert np.count_nonzero(across) == packing.provenance["twins"]
    volumes = np.bincount(phase, facets.volumes)
    balls = 4 / 3 * np.pi * np.array([0.35, inner]) ** 3
    # Rounding of some thousand cells, over what is left between two balls.
    assert_allclose(volumes, [1 - balls[0], balls[0] - balls[1], balls[1]], rtol=1e-7)


def stacks(*inclusions, close, periodic=True, least=0.0):
    return Interfaces(scene(*inclusions, periodic=periodic), 0.1, close=close, least=least).stacks


def test_which_planes_are_a_stack():
    layers = [Layer(0, a, b, OTHER) for a, b in ((0.1, 0.12), (0.15, 0.5), (0.56, 0.57))]
    found, inf = stacks(*layers, close=0.04), np.inf
    assert found.leader.tolist() == [0, 0, 0, 3, 4, 4]
    assert [column.tolist() for column in found.members] == [[1, -1, -1, -1, 5, -1], [2, -1, -1, -1, -1, -1]]
    gaps = [[inf, 0.02], [0.02, 0.03], [0.03, inf], [inf, inf], [inf, 0.01], [0.01, inf]]
    assert_allclose(found.apart, gaps, rtol=1e-12)  # rounding of places
    assert stacks(*layers, close=0.0).leader.tolist() == [0, 1, 2, 3, 4, 5]


def test_stacks_go_round_a_periodic_cell_and_end_at_walls():
    layers = [Layer(0, 0.01, 0.5, OTHER), Layer(0, 0.52, 0.985, OTHER)]
    found = stacks(*layers, close=0.03)
    assert found.leader.tolist() == [3, 1, 1, 3]
    assert_allclose(found.apart[[0, 3]], [[0.025, np.inf], [np.inf, 0.025]], rtol=1e-12)
    walled = stacks(*layers, close=0.025, periodic=False)
    assert walled.leader.tolist() == [0, 1, 1, 3]
    # Twice the way to a wall, to the mirror image, if that is close.
    assert_allclose(walled.apart[[0, 3]], [[0.02, np.inf], [np.inf, np.inf]], rtol=1e-12)


def test_which_spheres_are_a_stack():
    def ball(radius, *center):
        return Sphere(center or (0.5, 0.5, 0.5), radius, OTHER)

    shells = [ball(0.3), ball(0.29), ball(0.2), ball(0.1, 0.0, 0.0, 0.0), ball(0.095, 1.0, 1.0, 0.0)]
    found = stacks(*shells, close=0.02)
    assert found.leader.tolist() == [0, 0, 2, 3, 3]
    assert_allclose(found.apart[:2], [[0.01, np.inf], [np.inf, 0.01]], rtol=1e-12)
    assert np.isfinite(found.spacing).tolist() == [True, False, False, True, False]
    # Columns nearer to each other than allowed, about one centre in part only, or cut by a wall: none.
    assert stacks(*shells[:2], close=0.02, least=0.12).leader.tolist() == [0, 1]
    assert stacks(ball(0.3), ball(0.29, 0.501, 0.5, 0.5), close=0.02).leader.tolist() == [0, 1]
    assert stacks(ball(0.3, 0.2, 0.5, 0.5), ball(0.29, 0.2, 0.5, 0.5), close=0.02, periodic=False).leader[1] == 1


def test_particles_outside_give_way_as_beside_a_thick_layer():
    """By the offset on their own side, not by that between the faces."""
    packing = tiled(3000, size=(1.0,) * 3)
    radius, thin = packing.radii[0], 1e-3
    made = conform(packing, scene(Layer(2, 0.5, 0.5 + thin, OTHER)))
    off = np.maximum(0.5 - made.centers[:, 2], made.centers[:, 2] - 0.5 - thin)
    twins = np.abs(off - OFFSET * radius) < 1e-9
    # Of each column two, and one in the layer.
    assert np.count_nonzero(twins) == 2 * np.count_nonzero(off < 0) == made.provenance["twins"] / 2
    assert off[~twins & (off > 0)].min() > 2 * OFFSET * radius


@pytest.mark.parametrize("near", [Sphere((0.92, 0.5, 0.5), 0.16, OTHER), Sphere((0.52, 0.5, 0.5), 0.16, OTHER)])
def test_another_inclusion_near_a_stack_has_closer_columns_on_all_its_surfaces(near):
    """A hundredth from the outer sphere, or from the inner one, which is no leader."""
    shells = [Sphere((0.5,) * 3, 0.25, OTHER), Sphere((0.5,) * 3, 0.19, MATRIX)]
    packing, within = tiled(3000, size=(1.0,) * 3), []
    for given in (scene(*shells), scene(*shells, near)):
        made = conform(packing, given)
        within.append(np.count_nonzero(given.phase_at(made.centers) == 1))
    # In the shell: found 1.4 and 10 times as many.
    assert within[1] > 1.2 * within[0]


@pytest.mark.parametrize("axis", [0, 2])
def test_a_plate_from_face_to_face_has_no_gap_to_itself(axis):
    """It goes on in its own images: what seems near is beside."""
    plate = Box((0.5, 0.5, 0.3), (1.0, 1.0, 0.02), Material(50.0))
    field = solve(scene(plate, axis=axis), particles=1000)
    assert_allclose(field.conductivity, 1 / (0.98 + 0.02 / 50) if axis == 2 else 1.98, rtol=1e-7)  # the solver's
    made = field.stats["packing"]
    # The even pattern has points on the ends, too, where there is no surface.
    assert made["pairs_left_out"] == 0 and 300 < made["twins"] <= made["even_twins"]


def test_a_box_that_meets_its_image_with_an_edge_has_closer_twins_there():
    """Its faces end there, though those of the image lie in the same planes: a checkerboard."""
    turned = Box((0.5, 0.5, 0.5), (np.sqrt(0.5), np.sqrt(0.5), 1.0), OTHER, rotation=(0.0, 0.0, np.pi / 4))
    made = conform(tiled(1000, size=(1.0,) * 3), scene(turned)).provenance
    # Without them .74 of the even ones, as ends have none: 9 % too little where sqrt(10) is right, else 1.4 %.
    assert made["twins"] > 2 * made["even_twins"]
