"""All that computes, with the threads that the environment gives; writes the numbers to a file. Run as a script."""

import sys

import in_threads
import numpy as np
from in_threads import BOX, CELL, JOBS, MATRIX

from demheat import Scene, evolve, gallery, solve
from demheat.conduction import multigrid, products
from demheat.network.base import FEW

# Threads share what is more than a block, not what is worth it.
products.ROWS = multigrid.ROWS = products.kernels.BLOCK
MANY = FEW + 904
SLAB = Scene(CELL.size, MATRIX, walls=BOX.walls, initial=0.0)


def dem(solver):
    """So many unknowns that sums are shared out, and multigrid has levels of pyamg's."""
    field = solve(BOX, particles=MANY, solver=solver)
    return field.mean_flux, field.samples.temperature, field.heat_through(axis=0, position=0.5)


def multigrid_in_time():
    fields = list(evolve(BOX, [0.02], particles=MANY, integrator="tr-bdf2-multigrid"))
    return fields[0].samples.temperature, fields[0].mean_flux


def fft(scheme, rule, precision="float64"):
    from references import fft

    field = fft.solve(CELL, voxels=24, scheme=scheme, rule=rule, precision=precision, threads=None)
    return field.mean_flux, field.samples.temperature, field.flux_at(np.full((1, 3), 0.3))


def fem():
    from references import fem

    field = fem.solve(CELL, size=0.2)
    return field.mean_flux, field.samples.temperature, field.flux_at(np.full((1, 3), 0.3)), list(field.fractions)


def fem_in_time(scene, **knobs):
    from references import fem

    return [field.samples.temperature for field in fem.evolve(scene, [0.01], **knobs)]


def multipole():
    from references import multipole

    scene = gallery.dispersion(40, fraction=0.2)
    field = multipole.solve(scene, order=4)
    points = np.random.default_rng(0).random((200, 3)) * scene.size
    return field.mean_flux, field.temperature_at(points), multipole.zeta2(scene, order=4)


def exact_in_time():
    from references import exact

    return [field.samples.temperature for field in exact.evolve(SLAB, [0.01, 0.02], points_per_axis=5)]


ALL = {name: job for name, job in JOBS.items() if name not in ("amg", "tr-bdf2-multigrid", "fft", "fem")} | {
    "dem": lambda: dem("cg"),
    "amg": lambda: dem("amg"),
    "tr-bdf2-multigrid": multigrid_in_time,
    **{f"fft {rule}": lambda rule=rule: fft("cg", rule) for rule in ("plain", "laminate", "links")},
    "fft float32": lambda: fft("cg", "laminate", "float32"),
    "eyre-milton": lambda: fft("eyre-milton", "laminate"),
    "fem": fem,
    "fem in time": lambda: fem_in_time(BOX, size=0.4),
    "hexahedra in time": lambda: fem_in_time(SLAB, size=0.2, elements="hexahedra"),
    "multipole": multipole,
    "exact in time": exact_in_time,
}


def drawn():
    """Where NumPy's global generator stands."""
    return np.random.get_state()[1:3]  # noqa: NPY002


def main(path):
    in_threads.SHARED["field"] = solve(BOX, particles=500)
    before = np.concatenate([np.ravel(part) for part in drawn()])
    found = {name: np.concatenate([np.ravel(value) for value in job()]) for name, job in ALL.items()}
    found["generator moved"] = np.concatenate([np.ravel(part) for part in drawn()]) - before.astype(float)
    np.savez(path, **found)


if __name__ == "__main__":
    main(sys.argv[1])
