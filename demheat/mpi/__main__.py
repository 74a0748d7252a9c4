"""`mpiexec -n 2 python -m demheat.mpi scene.toml --particles 1000000`, or `--method fft --voxels 256`.

Methods besides DEM are found where their folder has a module `ranks`.

Exit status as that of `demheat`: 0; 1 if the solve was refused or failed; 2 for bad input, which one line names.
"""

import inspect
import sys
import traceback
import warnings
from importlib.util import find_spec

import numpy as np

from demheat.beyond import ranks
from demheat.declared import all_methods, load, path_of
from demheat.io.scenes import read
from demheat.io.words import nearest
from demheat.mpi.engines import world
from demheat.terminal.commands.options import Parser

# What all ranks raise alike, before anything heavy, and the exit status of each.
STATUS = {ValueError: 2, OSError: 2, NotImplementedError: 1, ImportError: 1}
ALIKE = tuple(STATUS)
# Words of the command line and the keywords of `solve` that they are.
KNOBS = {name: name for name in ("particles", "seed", "replicas", "voxels", "size", "tolerance")} | {"petsc": "options"}


def main(words=None) -> int:
    """Solve what a command line says, on every rank alike; the exit status."""
    comm = None
    try:
        options = _parser().parse_args(words)
        # What is heavy loads once MPI is known to be there.
        comm = world() if options.method == "dem" else ranks.imported(instead="demheat solve")[0].COMM_WORLD
        if comm.rank:
            warnings.simplefilter("ignore")
        _run(options, comm)
    except ALIKE as error:
        return _said(error, comm.rank if comm else 0)
    except (RuntimeError, MemoryError) as error:
        _said(error, 0)
        comm.Abort(1)
    except Exception:
        # Other ranks would wait for this one.
        traceback.print_exc()
        comm.Abort(1)
    return 0


def _run(options, comm):
    solver, knobs = _solver(options.method)
    knobs = knobs | _asked(options, solver)
    scene = read(options.scene)
    say = print if comm.rank == 0 else _silent
    size = {name: knobs[name] for name in inspect.signature(solver.outlook).parameters if name in knobs}
    say(f"{options.scene}: {solver.outlook(scene, **size)}", flush=True)
    field = solver.solve(scene, **knobs)
    _say_answer(field, say)
    if options.at:
        points = np.array(options.at)
        for point, value in zip(points.tolist(), field.temperature_at(points), strict=True):
            say(f"  temperature   {value:.9g} at {point}")
    if options.interval:
        error = field.error
        say(f"  expected      {error.lower:.9g} to {error.upper:.9g} W/(m K) ({error.how})")
    if options.write:
        own = field.samples
        if comm.rank == 0:
            np.savez(options.write, **own._asdict())
        say(f"  written       {options.write}")


def _solver(name):
    """The module that solves by a method on ranks, and the knobs that the method fixes."""
    if name == "dem":
        from demheat.mpi import solver

        return solver, {}
    if name not in all_methods():
        raise ValueError(
            f"--method {name}: no such method{nearest(name, all_methods()) or f'; on ranks are {_on_ranks()}'}"
        )
    if not _has_ranks(name):
        raise NotImplementedError(f"--method {name}: not on ranks, as are {_on_ranks()}; demheat solve runs it")
    return load(all_methods()[name].module, "ranks"), dict(all_methods()[name].knobs)


def _has_ranks(name):
    method = all_methods()[name]
    return method.call == "solve" and find_spec(f"{path_of(method.module)}.ranks") is not None


def _on_ranks():
    return ", ".join(
        dict.fromkeys(["dem", *(all_methods()[name].module for name in all_methods() if _has_ranks(name))])
    )


def _asked(options, solver):
    """Knobs of the command line."""
    given = {word: getattr(options, word) for word in KNOBS if getattr(options, word) is not None}
    takes = inspect.signature(solver.solve).parameters
    for word in given:
        if KNOBS[word] not in takes:
            raise ValueError(f"--{word}: no option of method {options.method}; must be left out")
    return {KNOBS[word]: value for word, value in given.items()}


def _say_answer(field, say):
    stats = field.stats
    try:
        say(f"  conductivity  {field.conductivity:.12g} W/(m K)")
    except (ValueError, KeyError):
        say(f"  mean flux     {field.mean_flux.tolist()} W/m2")
    for name, heat in field.wall_heat.items():
        say(f"  heat at {name}    {heat:.9g} W into the body")
    say(f"  unknowns      {stats['unknowns']}, residual {stats['residual']:.2g}, {stats['iterations']} iterations")
    for name in (key.removesuffix("_cpu_s") for key in stats if key.endswith("_cpu_s")):
        wall, cpu, most = (stats[f"{name}_{unit}"] for unit in ("s", "cpu_s", "bytes"))
        say(f"  {name:<13} {wall:.3g} s, {cpu:.3g} CPU-s on {stats['ranks']} ranks, {most / 2**30:.3g} GiB so far")
    more = stats["bytes"] - stats["bytes_before"]
    say(
        f"  memory        {stats['bytes'] / 2**30:.3g} GiB at the peak, of all ranks: {more / stats['unknowns']:.0f} "
        f"bytes an unknown, {stats['bytes_before'] / 2**30:.2g} GiB for Python and libraries besides",
        flush=True,
    )


def _parser():
    parser = Parser(prog="python -m demheat.mpi", description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.add_argument("scene", metavar="SCENE.toml")
    parser.add_argument("--method", default="dem", metavar="NAME", help="dem, which is the default, fft or fem")
    parser.add_argument("--particles", type=int, help="of dem; default: 1000000")
    parser.add_argument("--voxels", type=int, help="of fft, along the longest side; default: 128, or an image's")
    parser.add_argument("--size", type=float, metavar="METRES", help="of fem, the longest edge; default: by the body")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--tolerance", type=float, help="default: 1e-8 of dem, 1e-5 of fft, 1e-9 of fem")
    parser.add_argument("--replicas", type=int, help="of a smaller packing along the shortest side; default: by size")
    parser.add_argument("--at", type=float, nargs=3, action="append", metavar=("X", "Y", "Z"), help="in metres, again")
    parser.add_argument("--interval", action="store_true", help="solve with fewer particles too, and tell the error")
    parser.add_argument("--write", metavar="FILE.npz", help="samples of all particles")
    parser.add_argument("--petsc", metavar="OPTIONS", help="such as --petsc='-pc_type hypre'")
    return parser


def _silent(*_, **__):
    pass


def _said(error, rank):
    """One line on standard error, by the first rank."""
    told = " ".join(str(error).split()) or type(error).__name__
    status = next((status for kind, status in STATUS.items() if isinstance(error, kind)), 1)
    if rank == 0:
        print(f"demheat: {told}", file=sys.stderr, flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
