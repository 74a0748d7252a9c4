"""The beam and the sheet of Terreros et al. (2013), their packings, and what is read off their fields."""

from functools import cache

from demheat.dem.calibration import calibration
from demheat.dem.networks import network_of
from demheat.laws import LAWS
from demheat.packing.cache import relaxed
from demheat.packing.neighbours import contacts
from demheat.packing.radii import Uniform
from demheat.scene import Material, MovingCylinder, Scene

# Comput. Mater. Sci. 69 (2013) 46: material of both bodies, and spread of the radii.
METAL = Material(134.0, density=2790.0, heat_capacity=880.0)
SPREAD = Uniform(0.075)
# Section on the beam.
LENGTH, RADIUS, COLD, HOT = 2.184e-3, 0.116e-3, 298.0, 798.0
# Section on the sheet. The paper's y runs from -15 to 15 mm; the box's from 0 to 30.
SHEET, START, SPEED, POWER, DIAMETER, AMBIENT = (50e-3, 30e-3, 2e-3), (20e-3, 15e-3), 3.3e-3, 1e11, 8e-3, 25.0
POINTS = {"A": (9.5e-3, 14.5e-3, 1e-3), "B": (31e-3, 15e-3, 1e-3), "C": (41.5e-3, 5.5e-3, 1e-3)}
# Spheres of the periodic packing that gives the gap at which contacts are detected in the sheet.
BULK = 4_000


def beam():
    """Cylinder along x, 798 K at x = 0 from time 0 on, insulated elsewhere."""
    size = (LENGTH, 2 * RADIUS, 2 * RADIUS)
    return Scene(size=size, matrix=METAL, walls={"x-": HOT}, initial=COLD, domain="cylinder-x")


def sheet():
    """Insulated sheet with a cylinder of heat through its thickness that moves along its middle line."""
    source = MovingCylinder(axis=2, diameter=DIAMETER, power_density=POWER, start=START, velocity=(SPEED, 0.0))
    return Scene(size=SHEET, matrix=METAL, initial=AMBIENT, sources=(source,))


def packing_of(scene, particles, seed):
    """Packing between the walls of a body, radii as in the paper, kept in the cache."""
    domain = {} if scene.domain == "box" else {"domain": scene.domain}
    return relaxed(particles, size=scene.size, periodic=False, radii=SPREAD, seed=seed, **domain)


def steady_conductivity(packing, law, **contact):
    """Conductivity of a law's network between the beam's ends over the material's; with "calibrated", of C_t = 1."""
    kind = LAWS[law]
    if kind.factor is None:  # of a law that is calibrated
        contact["factor"] = 1.0
    between_ends = Scene(size=tuple(packing.size), matrix=Material(1.0), walls={"x-": 0.0, "x+": 1.0})
    return 1.0 / calibration(network_of(between_ends, packing, kind(**contact)), between_ends)


@cache
def bulk_gap(coordination):
    """Gap, over r_i + r_j, at which a periodic packing of such spheres has a mean number of contacts.

    The sheet has no particle four radii away from every wall, whose contacts could be counted.
    """
    return contacts(relaxed(BULK, radii=SPREAD, seed=0), coordination=coordination)[2]
