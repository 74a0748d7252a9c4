"""Only here: three loads on one set-up that are not three solves, or set up anew for each."""

from dataclasses import replace

import numpy as np
import pytest
from method_scenes import BOX, METHODS, pair
from numpy.testing import assert_allclose

import references.fem.multigrid
import references.fem.solver
import references.fem.system
import references.fft.solver
import references.multipole.truncation
from demheat import Flux, Layer, Material, Scene, Sphere, dem, gallery
from demheat.conduction import steady
from demheat.dem import networks
from demheat.tensor import axis_loads, conductivity_tensor
from references import exact, fem, fft, multipole
from studies.harness import methods

# How far a packing so coarse is off is not asked.
pytestmark = pytest.mark.filterwarnings("ignore:gaps beside inclusions")
OBLIQUE = (3.0, 0.0, -4.0)
# Two spheres with room around them, in a cell without any symmetry: few elements do.
SPHERES = [Sphere((0.3, 0.35, 0.25), 0.2, Material(20.0)), Sphere((0.7, 0.8, 0.5), 0.2, Material(0.2))]
# Those with a solve of their own; an evolve or a formula has no set-up to share. Finite elements have one way for all,
# and so have rules of links or voxels.
ALIKE = ("fem-", "dem-arithmetic", "dem-mean", "dem-plain", "fft-plain", "fft-em-plain")
STEADY = sorted(name for name, method in METHODS.items() if method.call == "solve" and not name.startswith(ALIKE))
SMALL = {
    # On networks of contacts rounding leaves residuals of 2e-12.
    dem: {"particles": 500, "tolerance": 1e-11},
    fem: {"size": 0.3, "tolerance": 1e-12},
    fft: {"voxels": 12, "tolerance": 1e-9, "threads": 1},
    multipole: {"order": 4},
    exact: {},
}


def mixed(**load):
    return Scene(BOX, Material(2.0), SPHERES, **load)


def both(module, scene, **knobs):
    """Fields by one set-up, and by three."""
    return module.solve_axes(scene, **knobs), [module.solve(load, **knobs) for load in axis_loads(scene)]


def same_fields(found, wanted):
    """To rounding: the same equations, solved in the same steps."""
    for one, other in zip(found, wanted, strict=True):
        assert one.scene == other.scene
        assert one.stats["iterations"] == other.stats["iterations"]
        scale = np.abs(other.mean_flux).max()
        # Rounding of walls' mean temperatures, where a wall is many facets or voxels.
        assert_allclose(one.conductivity, other.conductivity, rtol=1e-12)
        assert_allclose(one.mean_flux, other.mean_flux, rtol=0, atol=1e-11 * scale)
        points = np.random.default_rng(3).random((20, 3)) * one.scene.size
        # Solvers stop at residuals below 1e-9; where they end after as many steps only rounding is left.
        assert_allclose(one.flux_at(points), other.flux_at(points), rtol=0, atol=1e-8 * scale)
        assert_allclose(one.temperature_at(points), other.temperature_at(points), rtol=0, atol=1e-8 * 50.0)
        assert_allclose(one.fractions, other.fractions, rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", ["cell", "box"])
@pytest.mark.parametrize("name", STEADY)
def test_as_three_solves(name, kind):
    method = METHODS[name]
    module = methods.load(method.module)
    scene = mixed(gradient=OBLIQUE) if kind == "cell" else mixed(walls=dict(pair("y")))
    if module is exact:
        scene = replace(scene, size=(1, 1, 1), inclusions=[Sphere((0.5, 0.5, 0.5), 0.3, Material(20.0))])
    same_fields(*both(module, scene, **method.knobs, **SMALL[module]))


@pytest.mark.parametrize("load", [{"gradient": OBLIQUE}, {"walls": {"y-": 20.0, "y+": 50.0}}], ids=["cell", "box"])
def test_multigrid_is_kept_for_the_same_equations_only(load):
    """Walls hold other particles for each load: by another's multigrid it would take other iterations."""
    same_fields(*both(dem, mixed(**load), solver="amg", **SMALL[dem]))


@pytest.mark.parametrize("module", [dem, fem, fft])
@pytest.mark.parametrize("kind", ["cell", "box"])
def test_pores_cut_off_some_directions_only(module, kind):
    """What stands still differs from load to load, and with it the equations: nothing may be kept for the next."""
    load = {"gradient": (0.0, 5.0, 0.0)} if kind == "cell" else {"walls": {"y-": 20.0, "y+": 25.0}}
    scene = Scene((1.0, 1.2, 0.8), Material(2.0), [Layer(0, 0.2, 0.45, Material(0.0))], **load)
    knobs = SMALL[module] | ({"solver": "amg"} if module is dem else {})
    found, wanted = both(module, scene, **knobs)
    tensor = conductivity_tensor(found)
    assert_allclose(tensor, conductivity_tensor(wanted), rtol=0, atol=1e-10)
    # Layers are exact by all three; residuals and, between particles, their scatter are below.
    assert_allclose(tensor, np.diag([0.0, 1.5, 1.5]), rtol=0, atol=1e-6)


def test_set_up_once(monkeypatch):
    calls = []

    def counted(place, name):
        function = getattr(place, name)
        monkeypatch.setattr(place, name, lambda *a, **k: calls.append(name) or function(*a, **k))

    counted(networks, "conformed"), counted(networks, "laguerre"), counted(networks, "connect")
    counted(steady, "preconditioner")
    counted(references.fem.solver, "make"), counted(references.fem.system, "assemble_loads")
    counted(references.fem.multigrid, "multigrid")
    counted(references.fft.solver, "voxelise"), counted(references.fft.cg, "_system")
    counted(references.fft.eyre_milton, "_scheme"), counted(references.multipole.truncation, "exchange")
    cell = mixed(gradient=OBLIQUE)
    dem.solve_axes(cell, solver="amg", **SMALL[dem])
    fem.solve_axes(cell, **SMALL[fem])
    fft.solve_axes(cell, **SMALL[fft])
    fft.solve_axes(cell, scheme="eyre-milton", **SMALL[fft])
    multipole.solve_axes(cell, **SMALL[multipole])
    once = ["conformed", "laguerre", "connect", "preconditioner", "make", "assemble_loads", "multigrid"]
    assert calls == [*once, "voxelise", "_system", "voxelise", "_scheme", "exchange"]


@pytest.mark.parametrize("module", SMALL)
@pytest.mark.parametrize(
    "walls", [{"y-": 20.0, "y+": Flux(5.0)}, {"y-": 20.0, "x+": 25.0}, {"y-": 20.0, "y+": 25.0, "x-": 20.0}]
)
def test_other_loads_have_no_tensor(module, walls):
    scene = Scene((1.0, 1.0, 1.0), Material(2.0), walls=walls)
    with pytest.raises(NotImplementedError, match=r"^Scene.walls = .*only these have a tensor$"):
        module.solve_axes(scene)


def test_loads_are_as_steep_and_as_hot():
    cell, box = mixed(gradient=OBLIQUE), gallery.sphere_in_cube(temperatures=(35.0, 25.0))
    assert [load.gradient for load in axis_loads(cell)] == [(5.0, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 5.0)]
    assert [dict(load.walls) for load in axis_loads(box)] == [{name + "-": 35.0, name + "+": 25.0} for name in "xyz"]
    assert all(load.inclusions == box.inclusions for load in axis_loads(box))


def test_tensor_of_what_is_no_three_loads_is_refused():
    fields = exact.solve_axes(gallery.simple_cubic())
    x, y, z = fields
    with pytest.raises(ValueError, match="must be three"):
        conductivity_tensor(fields[:2])
    with pytest.raises(ValueError, match=r"fields\[0\].*along x alone"):
        conductivity_tensor((y, x, z))
    with pytest.raises(ValueError, match=r"fields\[1\].*of the body of fields\[0\]"):
        conductivity_tensor((x, exact.solve_axes(gallery.simple_cubic(2.0))[1], z))
    with pytest.raises(ValueError, match="must be a Field"):
        conductivity_tensor((x, y, 3.0))
    with pytest.raises(ValueError, match="same temperature"):
        conductivity_tensor(exact.solve_axes(gallery.slab(temperatures=(20.0, 20.0))))


def test_asymmetry_is_left_as_it_is():
    right = exact.solve_axes(gallery.simple_cubic())
    flux = np.array([field.mean_flux for field in right]) * [[1.0, 0.0, 0.0], [0.0, 0.99, 0.0], [0.0, 0.0, 1.01]]
    flux += np.abs(flux).max() * np.array([[0.0, 1e-3, 2e-3], [-1e-3, 0.0, 3e-3], [4e-3, -5e-3, 0.0]])
    fields = [replace(field, mean_flux=row) for field, row in zip(right, flux, strict=True)]
    steep = right[0].scene.gradient[0]
    assert_allclose(conductivity_tensor(fields), -flux.T / steep, rtol=1e-15)  # one division
