"""Jobs in several Python threads at once, then one after the other: the bits must be the same. Run as a script."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from demheat import Material, Scene, Sphere, evolve, solve

THREADS = 2
BALL = [Sphere(center=(0.5, 0.5, 0.5), radius=0.3, material=Material(5.0, density=1.0, heat_capacity=1.0))]
MATRIX = Material(1.0, density=1.0, heat_capacity=1.0)
CELL = Scene(size=(1.0, 1.0, 1.0), matrix=MATRIX, inclusions=BALL, gradient=(1.0, 0.0, 0.0))
BOX = Scene(size=(1.0, 1.0, 1.0), matrix=MATRIX, inclusions=BALL, walls={"x-": 0.0, "x+": 1.0}, initial=0.0)
LAYERED = Scene(size=(1.0, 1.0, 1.0), matrix=MATRIX, walls={"x-": 0.0, "x+": 1.0})
SHARED = {}


def dem(**knobs):
    field = solve(BOX, particles=500, **knobs)
    return field.mean_flux, field.samples.temperature


def in_time(integrator):
    fields = list(evolve(BOX, [0.01, 0.02], particles=300, integrator=integrator))
    return [field.samples.temperature for field in fields]


def lsa():
    from demheat.packing.lsa import lsa

    packing = lsa(200, phi=0.5)
    return packing.centers, packing.radii


def relax():
    from demheat.packing.relax import relax

    return (relax(400, seed=3).centers,)


def statistics():
    from demheat.packing import statistics
    from demheat.packing.neighbours import contacts
    from demheat.packing.relax import relax

    packing = relax(1000, seed=3)
    rows = contacts(packing)[:2]
    two_point = statistics.two_point(packing, r_max=2.0, points=11, lines=200)
    return (
        statistics.radial_distribution(packing, r_max=2.0).g,
        two_point.s2,
        statistics.fabric(packing, *rows).tensor,
        statistics.backbone(packing, *rows).rattler,
    )


def halo():
    from demheat.sampling.halo import halo_flux

    return (halo_flux(solve(BOX, particles=500), ratio=4.0),)


def one_field():
    """Values of one field at points of one's own: what is kept must not go to another thread."""
    field, values = SHARED["field"], []
    for k in range(5):
        points = np.random.default_rng(k).random((20, 3))
        values += [field.temperature_at(points), field.flux_at(points)]
    return values


def fft(scheme):
    from references import fft

    field = fft.solve(CELL, voxels=16, scheme=scheme, threads=2)
    return field.mean_flux, field.flux_at(np.full((1, 3), 0.3))


def fem():
    from references import fem

    field = fem.solve(CELL, size=0.4)
    return field.mean_flux, field.temperature_at(np.full((1, 3), 0.3))


def multipole():
    from references import multipole

    return (multipole.solve(CELL, order=5).mean_flux,)


def exact():
    from references import exact

    return (exact.solve(LAYERED).mean_flux,)


def bounds():
    from references import bounds

    return [np.array(bounds.estimate(CELL, formula=name)) for name in ("maxwell", "bruggeman")]


JOBS = {
    "laguerre": lambda: dem(),
    "amg": lambda: dem(solver="amg"),
    "calibrated": lambda: dem(law="calibrated"),
    "platonic": lambda: dem(law="platonic"),
    **{name: lambda name=name: in_time(name) for name in ("euler", "rkl2", "tr-bdf2", "tr-bdf2-multigrid")},
    "lsa": lsa,
    "relax": relax,
    "statistics": statistics,
    "halo": halo,
    "one field": one_field,
    "fft": lambda: fft("cg"),
    "eyre-milton": lambda: fft("eyre-milton"),
    "fem": fem,
    "multipole": multipole,
    "exact": exact,
    "bounds": bounds,
}


def check(names):
    """Every job THREADS times, all in one pool, then once alone; exits with the names of those whose bits differ."""
    if "one field" in names:
        SHARED["field"] = solve(BOX, particles=500)
    with ThreadPoolExecutor(THREADS) as pool:
        futures = [(name, pool.submit(JOBS[name])) for name in names for _ in range(THREADS)]
        found = [(name, future.result()) for name, future in futures]
    alone = {name: JOBS[name]() for name in names}
    differ = {name for name, values in found if not all(map(np.array_equal, values, alone[name]))}
    if differ:
        sys.exit(f"bits differ: {sorted(differ)}")


if __name__ == "__main__":
    check(sys.argv[1:] or list(JOBS))
