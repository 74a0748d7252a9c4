"""What any method owes, asked of all of them on the same scenes; what one does not claim has its reason beside it."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose

import demheat
from demheat import Flux, Layer, Material, Scene, Sphere, gallery, referee
from references import bounds, exact, fem, fft

# Identities hold to the solvers' tolerances below, times the condition of the system and of a sum over the walls.
IDENTITY = 1e-7
# Scenes for identities. A box without any symmetry; spheres cross faces and an edge of the cell, walls cut them.
BOX = (1.0, 1.2, 0.8)
SPHERES = [((0.05, 0.45, 0.4), 0.3, 20.0), ((0.4, 1.0, 0.15), 0.3, 0.2)]
OBLIQUE = (1.0, 2.0, -0.5)
LAYERS = [(0.23, 0.52, 20.0), (0.52, 0.81, 0.5)]
LOW, HIGH = 20.0, 50.0


class Method(NamedTuple):
    """A method at the size of these tests and what is declared of it there.

    Errors are 1.5 times the largest found on the scenes below, against an exact solution or a finer witness: relative
    of the conductivity; root mean square of temperature over the imposed span and of flux over the mean flux, at random
    points. `exceptions` holds the properties not claimed and why; `refuses` the loads and materials it cannot do.
    """

    solve: object
    conductivity: float
    temperature: float
    flux: float
    exceptions: dict = {}
    refuses: tuple = ()


def dem(**knobs):
    return lambda scene: demheat.solve(scene, particles=2000, tolerance=1e-11, **knobs)


def elements(edges, **knobs):
    return lambda scene: fem.solve(scene, size=max(scene.size) / edges, tolerance=1e-11, **knobs)


def voxels(scheme, rule):
    return lambda scene: fft.solve(scene, voxels=24, scheme=scheme, rule=rule, tolerance=1e-9, threads=1)


UNTURNED = {"rotation": "its particles or mesh do not turn with the scene"}
OVERSHOOT = {"maximum": "its matrix has positive couplings between neighbours"}
CUT = {"laminate": "links or voxels that cross an interface do not see where"}
REBUILT = {"samples": "the flux of a particle is rebuilt from the heat of its links"}
MEAN = {"patch": "only the mean over the packing is calibrated", "tensor": "and that along each load"}
SERIES = {"potential": "its temperature is a truncated Fourier series"}
SINGULAR = {"pores": "laminates of pore and solid need a thousand iterations; by default voxels are plain"}
BOX_LOADS, PORES = "walls", "pores"
METHODS = {
    "dem": Method(dem(), 4e-3, 2.5e-3, 0.1, UNTURNED | REBUILT),
    "dem-plain": Method(dem(conforming=False), 5e-2, 1e-2, 0.45, UNTURNED | REBUILT | CUT),
    "dem-calibrated": Method(dem(law="calibrated"), 0.13, 5.5e-2, 1.0, UNTURNED | REBUILT | CUT | MEAN),
    "fem-p1": Method(elements(10, order=1), 2.5e-2, 5e-3, 0.33, UNTURNED | OVERSHOOT),
    "fem-straight": Method(elements(6, curved=False), 1.3e-2, 2.5e-3, 0.25, UNTURNED | OVERSHOOT),
    "fem": Method(elements(6), 1.6e-3, 1.1e-3, 0.05, UNTURNED | OVERSHOOT),
    "fft": Method(voxels("cg", "laminate"), 2e-3, 3.3e-3, 0.1, OVERSHOOT | SINGULAR, (BOX_LOADS,)),
    "fft-plain": Method(voxels("cg", "plain"), 1.5e-2, 3.5e-3, 0.17, OVERSHOOT | CUT, (BOX_LOADS,)),
    "fft-links": Method(voxels("cg", "links"), 1.4e-2, 2.7e-3, 0.13, CUT, (BOX_LOADS, PORES)),
    "fft-em": Method(voxels("eyre-milton", "laminate"), 2e-3, 3e-3, 0.1, OVERSHOOT | SERIES, (BOX_LOADS, PORES)),
    "fft-em-plain": Method(voxels("eyre-milton", "plain"), 1.4e-2, 4e-3, 0.18, OVERSHOOT | CUT, (BOX_LOADS, PORES)),
}


def claiming(claim):
    return pytest.mark.parametrize("name", [name for name in METHODS if claim not in METHODS[name].exceptions])


every = claiming("")


def load(gradient=None, walls=None):
    return {"gradient": gradient, "walls": walls and dict(walls)}


def pair(axis, low=LOW, high=HIGH):
    """Two isothermal walls, as a hashable load."""
    return ((axis + "-", low), (axis + "+", high))


def mixed(*, factor=1.0, turn=0, matrix=2.0, **loaded):
    """A good and a poor sphere; all conductivities times a factor; axes turned cyclically."""
    spheres = [Sphere(np.roll(center, turn), radius, Material(k * factor)) for center, radius, k in SPHERES]
    return Scene(np.roll(BOX, turn), Material(matrix * factor), spheres, **load(**loaded))


def uniform(**loaded):
    """One material, but painted twice: methods that conform to interfaces do so."""
    return Scene(BOX, Material(2.0), [Sphere((0.4, 0.7, 0.4), 0.36, Material(2.0))], **load(**loaded))


def layers(**loaded):
    """Three materials across y; no interface lies on a face of voxels."""
    return Scene(BOX, Material(2.0), [Layer(1, *ends, Material(k)) for *ends, k in LAYERS], **load(**loaded))


def crossing(k, *, fraction=0.15, **loaded):
    """The simple cubic array, its cell cut so that the sphere crosses an edge of it."""
    radius = (3 * fraction / (4 * np.pi)) ** (1 / 3)
    return Scene((1, 1, 1), Material(1.0), [Sphere((0.07, 0.45, 0.98), radius, Material(k))], **load(**loaded))


@cache
def solved(name, scene, *arguments, **knobs):
    """The Field of a scene, made once for all tests."""
    return (METHODS[name].solve if name in METHODS else exact.solve)(scene(*arguments, **knobs))


def points_in(scene, count=400, seed=0):
    return np.random.default_rng(seed).random((count, 3)) * scene.size


def assert_same_flux(found, expected, tolerance):
    assert_allclose(found, expected, rtol=0, atol=tolerance * np.linalg.norm(expected))


# What a Field holds


@every
@pytest.mark.parametrize("loaded", [{"gradient": OBLIQUE}, {"walls": pair("y")}])
def test_samples_fill_the_box(name, loaded):
    field = solved(name, mixed, **loaded)
    own, size = field.samples, np.array(BOX)
    assert {len(column) for column in own} == {len(own.points)} and len(own.points) > 1000
    assert np.all((own.points >= 0) & (own.points <= size)) and own.volumes.min() > 0
    # Sums of rounded numbers.
    assert_allclose(own.volumes.sum(), size.prod(), rtol=1e-12)
    assert_allclose(field.fractions.sum(), 1.0, rtol=1e-12)
    assert field.fractions.shape == (3,) and set(own.phase.tolist()) == {0, 1, 2}
    method = METHODS[name]
    tolerance = method.conductivity if "samples" in method.exceptions else IDENTITY
    assert_same_flux(own.volumes @ own.flux / size.prod(), field.mean_flux, tolerance)
    assert np.isfinite(own.temperature).all()


@every
def test_stats(name):
    stats = solved(name, mixed, gradient=OBLIQUE).stats
    assert stats["unknowns"] > 500 and stats["iterations"] > 1
    # A residual of 0 was not measured.
    assert 0 < stats["residual"] < IDENTITY


@every
def test_fields_at_any_points(name):
    cell, walls = solved(name, mixed, gradient=OBLIQUE), solved(name, mixed, walls=pair("y"))
    inside = points_in(cell.scene, 60)
    corners = np.array([(x, y, z) for x in (0, 1.0) for y in (0, 1.2) for z in (0, 0.8)])
    center, radius, _ = SPHERES[0]
    special = np.vstack([corners, corners * (1, 0.5, 1), np.add(center, radius * np.eye(3)), inside])
    for field in (cell, walls):
        temperature, flux = field.temperature_at(special), field.flux_at(special)
        assert temperature.shape == special.shape[:1] and flux.shape == special.shape
        assert np.isfinite(temperature).all() and np.isfinite(flux).all()
        assert_allclose(field.temperature_at(special[5].tolist()), temperature[5:6], rtol=1e-14)
        assert field.flux_at(np.empty((0, 3))).shape == (0, 3)
    # A periodic cell goes on outside: rounding of the shifted points alone, which may cross from cell to cell.
    shift = np.array((2, -1, 3)) * BOX
    moved = cell.temperature_at(inside + shift) - cell.temperature_at(inside)
    assert_allclose(moved, shift @ OBLIQUE, rtol=1e-9)
    assert_allclose(cell.flux_at(inside + shift), cell.flux_at(inside), atol=1e-7)


@every
def test_walls_have_their_temperatures(name):
    field = solved(name, mixed, walls=pair("y"))
    assert field.wall_temperature == pytest.approx({"y-": LOW, "y+": HIGH}, abs=1e-9)
    wall = points_in(field.scene, 100)
    for y, value in ((0.0, LOW), (BOX[1], HIGH)):
        wall[:, 1] = y
        # Particles extrapolate from their centres to the wall, which costs up to twice the error inside.
        difference = field.temperature_at(wall) - value
        assert np.sqrt(np.mean(difference**2)) < 2 * METHODS[name].temperature * (HIGH - LOW)


# What conduction obeys


@claiming("maximum")
def test_maximum_principle(name):
    temperature = solved(name, mixed, walls=pair("y")).samples.temperature
    slack = IDENTITY * (HIGH - LOW)
    assert LOW - slack <= temperature.min() < LOW + 3 and HIGH - 3 < temperature.max() <= HIGH + slack


@every
def test_heat_in_is_heat_out(name):
    field = solved(name, mixed, walls=pair("y"))
    assert field.wall_heat["y-"] < 0 < field.wall_heat["y+"]
    assert abs(referee.heat_balance(field)) < IDENTITY
    # The mean of the flux along the load is the heat through either wall, by the divergence theorem.
    assert_allclose(field.mean_flux[1] * BOX[0] * BOX[2], field.wall_heat["y-"], rtol=IDENTITY)


@claiming("patch")
@pytest.mark.parametrize("loaded", [{"gradient": OBLIQUE}, {"walls": pair("y")}])
def test_linear_fields_are_exact(name, loaded):
    field = solved(name, uniform, **loaded)
    slope = np.array(loaded.get("gradient", (0.0, (HIGH - LOW) / BOX[1], 0.0)))
    points = points_in(field.scene)
    error = field.temperature_at(points) - points @ slope
    assert_allclose(error - error.mean(), 0, atol=IDENTITY * referee.span(field.scene))
    if field.scene.walls:
        assert_allclose(error.mean(), LOW, rtol=IDENTITY)
    assert_same_flux(field.flux_at(points), np.tile(-2 * slope, (len(points), 1)), IDENTITY)
    assert_same_flux(field.mean_flux, -2 * slope, IDENTITY)


@claiming("laminate")
@pytest.mark.parametrize("loaded", [{"gradient": OBLIQUE}, {"walls": pair("y")}, {"walls": pair("x")}])
def test_laminates_are_exact_across_and_along(name, loaded):
    field, right = solved(name, layers, **loaded), solved("exact", layers, **loaded)
    assert_same_flux(field.mean_flux, right.mean_flux, IDENTITY)
    assert_allclose(field.fractions, right.fractions, atol=1e-12)
    # Voxels cut by an interface hold both materials: points at least two voxels of 0.05 away.
    points = points_in(field.scene)
    points = points[np.min(np.abs(points[:, 1:2] - np.unique([ends[:2] for ends in LAYERS])), axis=1) > 0.1]
    assert len(points) > 150
    assert_same_flux(field.flux_at(points), right.flux_at(points), IDENTITY)
    error = field.temperature_at(points) - right.temperature_at(points)
    error -= error.mean() if field.scene.periodic else 0.0
    tolerance = METHODS[name].temperature if "potential" in METHODS[name].exceptions else IDENTITY
    assert_allclose(error, 0, atol=tolerance * referee.span(field.scene))


@every
def test_conductivities_scale_the_flux_and_the_load_reverses_it(name):
    field, back = solved(name, mixed, walls=pair("y")), solved(name, mixed, factor=7.0, walls=pair("y", HIGH, LOW))
    assert_same_flux(back.mean_flux, -7 * field.mean_flux, IDENTITY)
    points = points_in(field.scene)
    assert_allclose(back.temperature_at(points), LOW + HIGH - field.temperature_at(points), rtol=IDENTITY)


@every
def test_rotating_the_scene_rotates_the_flux(name):
    method = METHODS[name]
    field, turned = (solved(name, mixed, turn=t, gradient=tuple(np.roll(OBLIQUE, t))) for t in (0, 1))
    # Voxels turn with the scene. Other packings and meshes are other approximations, each with its own error.
    tolerance = 2 * method.conductivity if "rotation" in method.exceptions else IDENTITY
    assert_same_flux(np.roll(turned.mean_flux, -1), field.mean_flux, tolerance)


@claiming("tensor")
def test_the_tensor_is_symmetric_positive_and_linear(name):
    gradients = np.array([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), OBLIQUE])
    fields = [solved(name, mixed, gradient=tuple(gradient)) for gradient in gradients]
    # Were the oblique flux not the sum of three along the axes, its row would not be symmetric.
    tensor = np.linalg.solve(gradients, [-field.mean_flux for field in fields])
    assert_allclose(tensor, tensor.T, atol=10 * IDENTITY)
    assert np.abs(tensor[~np.eye(3, dtype=bool)]).min() > 1e-3  # The scene is not too symmetric to tell.
    k, fractions, slack = fields[0].scene.conductivities, fields[0].fractions, METHODS[name].conductivity
    low, *_, high = np.linalg.eigvalsh((tensor + tensor.T) / 2)
    assert bounds.reuss(k, fractions) * (1 - slack) <= low <= high <= bounds.voigt(k, fractions) * (1 + slack)


@every
@pytest.mark.parametrize("k", [0.1, 10.0])
def test_isotropic_scenes_obey_hashin_and_shtrikman(name, k):
    field = solved(name, crossing, k, gradient=(0.0, 1.0, 0.0))
    lower, upper = bounds.hashin_shtrikman(1.0, k, field.fractions[1])
    # The cubic array lies within 0.2 % of one bound, so no more than the method's own error is left.
    assert abs(referee.bound_violation(field, lower, upper)) < METHODS[name].conductivity
    assert min(field.conductivity / lower - 1, 1 - field.conductivity / upper) < 2 * METHODS[name].conductivity


# How near the truth they are


EXACT = {
    "crossing": (crossing, (10.0,), {"gradient": (0.0, 1.0, 0.0)}),
    "poor": (crossing, (0.1,), {"gradient": (0.0, 1.0, 0.0)}),
    "coated": (
        gallery.coated_sphere,
        (8.0, 1.0),
        {"radius": 0.42, "periodic": True, "center": (0.1, 0.5, 0.63), "edge": 1.0},
    ),
    "walls": (gallery.sphere_in_cube, (10.0,), {"fraction": 0.15, "axis": 2, "edge": 1.0}),
}


@every
@pytest.mark.parametrize("scene", EXACT)
def test_declared_errors(name, scene):
    make, arguments, knobs = EXACT[scene]
    field, right = solved(name, make, *arguments, **knobs), solved("exact", make, *arguments, **knobs)
    method, points = METHODS[name], points_in(field.scene)
    assert abs(referee.conductivity_error(field, right)) < method.conductivity
    assert referee.temperature_error(field, right, points).rms < method.temperature
    assert referee.flux_error(field, right, points).rms < method.flux


@every
def test_a_neutral_coated_sphere_is_not_noticed(name):
    """Outside it the field is linear: the error there is that of the method, not of the scene."""
    make, arguments, knobs = EXACT["coated"]
    field = solved(name, make, *arguments, **knobs)
    points = points_in(field.scene, 800)
    outside = points[field.scene.phase_at(points) == 0]
    error = field.temperature_at(outside) - outside @ field.scene.gradient
    assert len(outside) > 400 and np.std(error) < METHODS[name].temperature * referee.span(field.scene)
    assert_allclose(field.conductivity, field.scene.matrix.conductivity, rtol=METHODS[name].conductivity)


def dispersion(**loaded):
    cell = gallery.random_dispersion(2, fraction=0.18, gap=0.15, edge=1.0, seed=4)
    return Scene(cell.size, cell.matrix, cell.inclusions, **load(**loaded))


@every
def test_a_random_dispersion_is_the_same_for_all(name):
    loaded = {"gradient": OBLIQUE}
    field, fine = solved(name, dispersion, **loaded), finer(**loaded)
    # The witness at 64 voxels errs by 0.1 % at most: a third of its error at 32, where spheres are twice as coarse.
    assert_same_flux(field.mean_flux, fine.mean_flux, METHODS[name].conductivity + 1e-3)
    points = points_in(field.scene)
    assert referee.temperature_error(field, fine, points).rms < METHODS[name].temperature


@cache
def finer(**loaded):
    return fft.solve(dispersion(**loaded), voxels=64, rule="laminate", threads=1)


# What they refuse


@every
def test_an_imposed_flux_enters_or_is_refused(name):
    walls = (("x-", LOW), ("y+", Flux(30.0)))
    if BOX_LOADS in METHODS[name].refuses:
        with pytest.raises(NotImplementedError, match="Scene.walls"):
            solved(name, mixed, walls=walls)
        return
    field = solved(name, mixed, walls=walls)
    (cold, _), (warm, flux) = walls
    assert_allclose(field.wall_heat[warm], flux.value * BOX[0] * BOX[2], rtol=1e-12)
    assert abs(referee.heat_balance(field)) < IDENTITY
    assert field.wall_temperature[cold] == pytest.approx(LOW) and field.wall_temperature[warm] > LOW + 5


@claiming("pores")
def test_a_pore_is_solved_or_refused(name):
    if PORES in METHODS[name].refuses:
        with pytest.raises(NotImplementedError, match="conductivity is 0"):
            solved(name, crossing, 0.0, gradient=(1.0, 0.0, 0.0))
        return
    field, right = (solved(n, crossing, 0.0, gradient=(1.0, 0.0, 0.0)) for n in (name, "exact"))
    assert abs(referee.conductivity_error(field, right)) < METHODS[name].conductivity


@every
def test_bad_scenes_and_points(name):
    with pytest.raises(ValueError, match="at least one wall with a temperature"):
        METHODS[name].solve(mixed(walls=(("y-", Flux(1.0)), ("y+", Flux(-1.0)))))
    for at in (solved(name, mixed, gradient=OBLIQUE).temperature_at, solved(name, mixed, gradient=OBLIQUE).flux_at):
        with pytest.raises(ValueError):
            at([(0.5, np.nan, 0.5)])


def test_what_has_no_closed_form_is_refused():
    with pytest.raises(NotImplementedError, match="no closed form"):
        solved("exact", mixed, gradient=OBLIQUE)
