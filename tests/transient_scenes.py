"""Bodies of metal for tests of conduction in time by the discrete element method."""

from demheat import Material, Scene, evolve

METAL = Material(33.0, density=7800.0, heat_capacity=0.9)
ALUMINIUM = Material(185.0, density=2700.0, heat_capacity=900.0)
BOX = (0.1, 0.1, 0.1)
SLAB = Scene(size=BOX, matrix=METAL, walls={"y-": 25.0, "y+": 35.0}, initial=25.0)
INTEGRATORS = ("euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid")


def last(scene, times, **knobs):
    """The field at the last of some times, of a thousand particles unless it is said."""
    *_, field = evolve(scene, times, **{"particles": 1000} | knobs)
    return field
