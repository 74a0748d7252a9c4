"""spheropack: packings by the Lubachevsky-Stillinger algorithm (C++), with our network and solver on them.

Radii are those of Haddad et al. (2021), Gaussian of a spread of 0.3, between flat walls, where some thousand of them
jam below the papers' 0.64 (`density="max"` goes there); cost is that of the packing alone. Its documentation says that
equal spheres jam at 0.64 at its default growth rate: `own`.
"""

from functools import cache
from pathlib import Path

import numpy as np

from studies.peers import packages
from studies.peers.outside import Found, asked, python_of, ran

TITLE = "spheropack"
KIND = "packing"
GET = "pip: spheropack"
CANNOT = {"conductivities": "it packs spheres; network and solver are ours", "overlaps": "its spheres are hard"}
BODIES = ("homogeneous", "layers off the grid", "sphere 10", "sphere 0.01", "half 10")
CASES = (
    *({"scene": body, "particles": 2000, "conforming": True} for body in BODIES),
    {"scene": "sphere 10", "particles": 2000, "conforming": False},
    {"scene": "sphere 10", "particles": 2000, "conforming": True, "density": "max"},
    {"scene": "sphere 10", "particles": 8000, "conforming": True},
)
EXPLAINED = "the error is that of the network, which is ours; packings matter where no twins stand at interfaces"
SCRIPT = Path(__file__).parent / "scripts" / "spheropack_pack.py"
# Fraction that packings between walls reach well before they jam, and growth rate, its default.
DENSITY, GROWTH = 0.58, 0.02
missing, version = packages.asked_of("spheropack", GET)


def solve(scene, *, particles, conforming, density=DENSITY, seed=0) -> Found:
    """Conductivity by our network on a packing of spheropack."""
    from demheat import dem
    from demheat.packing import Gaussian, make_packing

    if getattr(scene, "domain", None) != "box" or scene.periodic:
        raise NotImplementedError("spheropack: rows are of boxes between walls")
    radii = Gaussian().draw(particles, np.random.default_rng(seed))
    found = packed(radii, scene.size, density, seed)
    packing = make_packing(found["centers"], found["radii"], scene.size, False, {"algorithm": "spheropack"})
    field = dem.solve(scene, packing=packing, conforming=conforming, seed=seed, tolerance=1e-12)
    note = f"{found['status']} at {found['density']:.4f}, {found['n_collisions'] / particles:.0f} collisions a sphere"
    note += f", least gap {found['min_gap']:.0e}; {_ours(radii, scene.size, density, seed)}"
    return Found(field.conductivity, found["cost"], unknowns=field.stats["unknowns"], note=note)


def packed(radii, size, density, seed) -> dict:
    """A packing between walls, as the script tells it."""
    # As fractions are reached by growing, any small scale is as good as another.
    start = 0.2 * np.min(size) * radii / radii.sum()
    given = {"radii": start.tolist(), "size": list(size), "density": density, "growth": GROWTH, "seed": seed}
    return asked(python_of("spheropack"), SCRIPT, given, environment={"OMP_NUM_THREADS": "1"})


def _ours(radii, size, density, seed):
    """The same spheres by our algorithm of the same kind, in words."""
    packing, cost = _grown(tuple(radii.tolist()), tuple(size), density, seed)
    return f"our LSA {packing.phi:.4f} in {cost['cpu_s']:.2f} CPU-s"


@cache
def _grown(radii, size, density, seed):
    from demheat.packing.lsa import lsa
    from studies.harness.cost import measured

    goal = {"pressure": 1e6} if density == "max" else {"phi": density}
    lsa(200, phi=0.45, periodic=False, seed=0)  # loads the compiled kernels
    return measured(lsa, len(radii), radii=np.array(radii), size=size, periodic=False, seed=seed, growth=GROWTH, **goal)


def own():
    """Fraction at which 1000 equal spheres jam in a periodic cube at the default growth rate."""
    code = "import spheropack as s; print(s.pack(n=1000, density='max', seed=1).density)"
    printed, _ = ran([python_of("spheropack"), "-c", code])
    return float(printed.split()[-1]), 0.64, "help of spheropack.pack, growth_rate"
