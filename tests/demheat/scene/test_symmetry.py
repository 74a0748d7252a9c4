"""Only here: mirror planes found where there are none, or missed; a part that is not the whole unfolded."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from demheat import Flux, Layer, Material, Scene, Sphere, UniformSource, gallery
from demheat.scene.symmetry import alike_axes, mirrors, reduced, unfold
from references import exact, multipole

ALL = (2, 2, 2)
GOOD, POOR = Material(30.0), Material(0.1)


def cell(*inclusions, size=(1.0, 1.0, 1.0), gradient=(0.0, 2.0, 0.0)):
    return Scene(size, Material(2.0), inclusions, gradient=gradient)


def box(*inclusions, size=(1.0, 1.0, 1.0), **walls):
    walls = {name[0] + {"m": "-", "p": "+"}[name[1]]: value for name, value in walls.items()}
    return Scene(size, Material(2.0), inclusions, walls=walls or {"y-": 20.0, "y+": 50.0})


def mirrored(place, radius, material, planes, axes=(0, 1, 2)):
    """A sphere and its mirror images, in a body of edge 1 with planes across some axes."""
    places = {tuple(place)}
    for axis in axes:
        places |= {tuple(np.where(np.arange(3) == axis, 2 * planes[axis] - np.array(p), p)) for p in places}
    return [Sphere(tuple(np.round(p, 12) % 1.0), radius, material) for p in sorted(places)]


# Planes at .2, .35 and .05 (and half a period on); a layer that crosses a face of the cell where it begins.
SKEWED = cell(
    *mirrored((0.4, 0.5, 0.2), 0.08, GOOD, (0.2, 0.35, 0.05)),
    *mirrored((0.4, 0.5, 0.2), 0.04, POOR, (0.2, 0.35, 0.05)),
    Sphere((0.2, 0.35, 0.55), 0.15, POOR),
)
LAYERED = cell(Layer(0, 0.0, 0.1, GOOD), Layer(0, 0.9, 1.0, GOOD), Layer(0, 0.4, 0.6, POOR), gradient=(1.0, 0.0, 0.0))
MIDDLE = (0.5, 0.5, 0.5)
BOXED = box(
    *mirrored((0.25, 0.3, 0.2), 0.12, GOOD, MIDDLE),
    Sphere((0.5, 0.5, 0.5), 0.1, POOR),
    Sphere((0.5, 0.5, 0.5), 0.05, GOOD),
)
# Cut by the walls beside their centres, which lie outside.
OUTSIDE = box(*(Sphere((x, y, 0.5), 0.2, GOOD) for x in (-0.15, 1.15) for y in (0.25, 0.75)))
CUBIC = {
    "sc": gallery.simple_cubic(20.0),
    "bcc": gallery.body_centred(20.0, axis=0),
    "fcc": gallery.face_centred(0.05, axis=2),
    "cube": gallery.sphere_in_cube(20.0),
}
SYMMETRIC = {
    "skewed": SKEWED,
    "layered": LAYERED,
    "boxed": BOXED,
    "outside": OUTSIDE,
    "coated": gallery.coated_sphere(),
    **CUBIC,
}


def test_planes_of_cells_and_boxes():
    assert_allclose(mirrors(SKEWED), (0.2, 0.35, 0.05), rtol=0, atol=1e-12)  # rounding
    assert mirrors(LAYERED) == (0.0, 0.0, 0.0)
    assert mirrors(BOXED) == MIDDLE
    # Body-centred: planes through the spheres; a cell moved by a quarter of its edge has them elsewhere.
    edge = CUBIC["bcc"].size[0]
    assert_allclose(mirrors(CUBIC["bcc"]), [edge / 4] * 3, rtol=1e-12)
    shifted = [replace(s, center=np.add(s.center, (0.1 * edge, 0.3 * edge, 0.0))) for s in CUBIC["bcc"].inclusions]
    assert_allclose(mirrors(replace(CUBIC["bcc"], inclusions=shifted)), edge * np.array([0.35, 0.05, 0.25]), rtol=1e-9)


def test_some_planes_only():
    pair = [Sphere((0.3, 0.4, 0.5), 0.1, GOOD), Sphere((0.7, 0.4, 0.5), 0.1, GOOD)]
    assert mirrors(box(*pair)) == (0.5, None, 0.5)
    # In a cell every place may be the middle.
    assert_allclose(mirrors(cell(*pair)), (0.0, 0.4, 0.0), rtol=0, atol=1e-12)
    # A third sphere leaves the plane through all three.
    assert mirrors(cell(*pair, Sphere((0.5, 0.8, 0.5), 0.1, POOR)))[1:] == (None, 0.0)
    assert mirrors(cell(*pair, Sphere((0.61, 0.8, 0.5), 0.1, POOR))) == (None, None, 0.0)


@pytest.mark.parametrize("moved", [1e-3, 1e-10])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_one_inclusion_out_of_place_and_nothing_is_cut(moved, axis):
    for scene in (SKEWED, BOXED):
        for number in (0, 5):
            inclusions = list(scene.inclusions)
            one = inclusions[number]
            inclusions[number] = replace(one, center=np.add(one.center, moved * np.eye(3)[axis]))
            assert mirrors(replace(scene, inclusions=inclusions))[axis] is None
            inclusions[number] = replace(one, radius=one.radius + moved)
            part = reduced(replace(scene, inclusions=inclusions))
            assert part.factors == (1, 1, 1) and part.scene is part.whole


def test_materials_and_layers_count():
    first, *rest = BOXED.inclusions
    other = replace(first, material=replace(GOOD, conductivity=30.0 + 1e-9))
    assert mirrors(replace(BOXED, inclusions=(other, *rest))) == (None, None, None)
    assert mirrors(box(Layer(1, 0.3, 0.701, GOOD))) == (0.5, None, 0.5)
    assert mirrors(box(Layer(1, 0.3, 0.7, GOOD))) == (0.5, 0.5, 0.5)
    # Two layers in a cell mirror each other in the middle between them, were they alike; these are not.
    assert mirrors(cell(Layer(0, 0.1, 0.3, GOOD), Layer(0, 0.4, 0.5, GOOD), Layer(0, 0.8, 0.9, POOR)))[0] is None
    assert_allclose(mirrors(cell(Layer(0, 0.1, 0.3, GOOD), Layer(0, 0.4, 0.5, POOR)))[1:], (0.0, 0.0))


def test_rounding_is_forgiven():
    """Thirds and tenths as they are typed and worked out."""
    edge = 0.1 * 3
    spheres = [Sphere((edge / 3, 0.1, 0.15), 0.04, GOOD), Sphere((edge - 0.1, 0.2, 0.15), 0.04, GOOD)]
    spheres += [Sphere((0.1, 0.2, edge / 2), 0.04, GOOD), Sphere((0.2, edge / 3, 0.15), 0.04, GOOD)]
    assert None not in mirrors(box(*spheres, size=(0.3, edge, 0.3)))


def test_other_shapes_and_bodies():
    class Other(Sphere):
        """Known by its type to be a sphere."""

    part = reduced(box(Other(MIDDLE, 0.2, GOOD)))
    assert part.factors == ALL and part.scene.inclusions == (Other(MIDDLE, 0.2, GOOD),)
    drum = Scene((1, 1, 1), Material(1.0), walls={"round": 3.0}, domain="sphere", initial=0.0)
    assert mirrors(drum) == (None, None, None) and alike_axes(drum) == (0, 1, 2)


def test_axes_alike():
    assert all(alike_axes(scene) == (0, 0, 0) for scene in CUBIC.values())
    assert alike_axes(LAYERED) == (0, 1, 1)
    assert alike_axes(gallery.slab(size=(0.1, 0.1, 0.2))) == (0, 0, 2)
    assert alike_axes(gallery.random_dispersion()) == (0, 1, 2)
    # A screw: a quarter turn about z with a quarter of the height, in a cell and not between walls.
    turns = [(0.3, 0.0), (0.0, 0.3), (-0.3, 0.0), (0.0, -0.3)]
    screw = [Sphere((0.5 + x, 0.5 + y, 0.125 + 0.25 * i), 0.1, GOOD) for i, (x, y) in enumerate(turns)]
    assert alike_axes(cell(*screw)) == (0, 0, 2) and mirrors(cell(*screw)) == (None, None, None)
    # Half a turn about a diagonal across it is left between walls, if it stands in the middle.
    assert alike_axes(box(*screw)) == (0, 0, 2)
    aside = [replace(sphere, center=np.add(sphere.center, (0.1, 0.0, 0.0))) for sphere in screw]
    assert alike_axes(cell(*aside)) == (0, 0, 2) and alike_axes(box(*aside)) == (0, 1, 2)
    # A third of a turn about the diagonal alone.
    three = [Sphere(np.roll((0.2, 0.5, 0.6), turn), 0.1, GOOD) for turn in range(3)]
    assert alike_axes(cell(*three)) == alike_axes(box(*three)) == (0, 0, 0)
    three[0] = replace(three[0], center=np.add(three[0].center, (1e-9, 0, 0)))
    assert alike_axes(cell(*three)) == alike_axes(box(*three)) == (0, 1, 2)


@pytest.mark.parametrize("name", SYMMETRIC)
def test_part_is_the_whole_unfolded(name):
    """The same material at every point: one placed too many, or not cut where it should be, shows."""
    scene = SYMMETRIC[name]
    part = reduced(scene)
    assert part.factors == ALL
    assert_allclose(np.array(part.scene.size) * 2, scene.size, rtol=1e-15)
    points = np.random.default_rng(1).random((4000, 3)) * scene.size
    inside = unfold(part, points).points
    assert np.all((inside >= 0) & (inside <= part.scene.size))
    k, wanted = part.scene.conductivities, scene.conductivities
    # Points within rounding of an interface would belong to either side; of these none is.
    assert np.array_equal(k[part.scene.phase_at(inside)], wanted[scene.phase_at(points)])
    # Something of the inclusions is there to be compared.
    assert len(set(wanted[scene.phase_at(points)])) == len(set(wanted))


def test_loads_of_the_part():
    assert dict(reduced(BOXED).scene.walls) == {"y-": 20.0, "y+": 35.0}
    assert dict(reduced(SKEWED).scene.walls) == pytest.approx({"y-": 2 * 0.35, "y+": 2 * 0.85})
    assert dict(reduced(replace(LAYERED, gradient=(0, 0, -3.0))).scene.walls) == {"z-": 0.0, "z+": -1.5}


def test_what_the_load_does_not_allow_is_not_cut():
    assert reduced(replace(SKEWED, gradient=(1.0, 1.0, 0.0))).factors == (1, 1, 1)
    some = cell(Sphere((0.5, 0.5, 0.5), 0.1, GOOD), Sphere((0.7, 0.8, 0.5), 0.1, POOR))
    assert mirrors(some) == (None, None, 0.0)
    assert reduced(some).factors == (1, 1, 1) and reduced(some).scene is some
    sphere = Sphere((0.5, 0.5, 0.5), 0.2, GOOD)
    assert reduced(box(sphere, ym=20.0, yp=Flux(5.0))).factors == (2, 1, 2)
    assert reduced(box(sphere, ym=20.0, xp=25.0)).factors == (1, 1, 2)
    assert reduced(box(sphere, ym=20.0, yp=30.0, xm=25.0)).factors == (1, 1, 2)
    assert reduced(box(replace(sphere, center=(0.5, 0.4, 0.5)))).factors == (2, 1, 2)
    with pytest.raises(ValueError, match="at least one wall with a temperature"):
        reduced(box(sphere, ym=Flux(3.0)))
    with pytest.raises(NotImplementedError, match="heat sources"):
        reduced(replace(box(sphere), sources=[UniformSource(3.0)]))


@pytest.mark.parametrize("name", ["bcc", "cube"])
def test_field_of_the_part_unfolded_is_that_of_the_whole(name):
    """Against the exact field of the lattice, at points anywhere, in other periods too."""
    scene = CUBIC[name]
    part, whole = reduced(scene), exact.solve(scene)
    field = multipole.solve(part.scene, order=13)
    spread = 3.0 if scene.periodic else 1.0
    points = (np.random.default_rng(5).random((400, 3)) * spread - (spread - 1) / 2) * scene.size
    at = unfold(part, points)
    span = np.ptp(whole.temperature_at(points))
    found = at.rise + at.sign * field.temperature_at(at.points)
    wanted = whole.temperature_at(points)
    # Both are the mean gradient times the position plus what has no mean. Degrees beyond 13 are left out.
    assert_allclose(found, wanted, rtol=0, atol=2e-5 * span)
    flux = at.signs * field.flux_at(at.points)
    assert_allclose(flux, whole.flux_at(points), rtol=0, atol=2e-3 * np.abs(whole.mean_flux).max())
