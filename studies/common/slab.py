"""The slab of Haddad et al. (2021), figure 5: its scene, and its network by law."""

from demheat.scene import Material, Scene

# Section on transient conduction; its Table 1 prints a heat capacity of 0.9 J/(kg K), a thousandth of a metal's.
LENGTH, COLD, HOT = 0.1, 25.0, 35.0
TIMES = (0.05, 0.1, 0.2)
METAL = Material(33.0, density=7800.0, heat_capacity=0.9)


def slab():
    """Cube at 25 C, its top at 35 C from time 0 on, its bottom at 25 C, its sides insulated."""
    return Scene(size=(LENGTH,) * 3, matrix=METAL, walls={"y-": COLD, "y+": HOT}, initial=COLD)


def packing_of(particles, seed=0):
    """Packing between the slab's walls, kept in the cache."""
    from demheat.packing.cache import relaxed

    return relaxed(particles, size=slab().size, periodic=False, seed=seed)
