"""LIGGGHTS: a DEM code with one temperature for each grain; `fix heat/gran/conduction`, explicit steps to steadiness.

A contact conducts 4 k_1 k_2/(k_1 + k_2) times the root of the area of the circle in which two spheres cut each other
(its manual, `fix heat/gran`): sqrt(pi) times the 4 a/(1/k_1 + 1/k_2) of a disc between half-spaces, which Batchelor and
O'Brien (1977) and Chaudhuri et al. (2006), whom the manual cites, have. Nothing moves; held grains store 1e30 times
what others do. Debian's LIGGGHTS-PUBLIC 3.8.0; its documentation prints no value, so `own` is not there.
"""

import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from studies.peers import beds
from studies.peers.outside import Found, ran

TITLE = "LIGGGHTS"
KIND = "packing"
GET = "apt: liggghts"
CANNOT = {
    "solids": "grains exchange heat through contacts alone; a body is no packing to it",
    "steady states at once": "it marches in time, explicitly",
    "what a disc between half-spaces conducts": "its contacts conduct sqrt(pi) times as much",
}
LAW = "root of area"
CASES = (
    *beds.cases(LAW),
    {"scene": "chain, disc", "n": 10},
    {"scene": "random bed, disc"},
)
EXPLAINED = "of a disc between half-spaces sqrt(pi) - 1 = 77 %: the root of the contact's area, not its radius"
DENSITY, HELD = 1000.0, 1e30


def missing() -> str | None:
    """None, or that it is not installed."""
    return None if shutil.which("liggghts") else "liggghts is not installed (apt: liggghts)"


@cache
def version() -> str:
    """As it says of itself."""
    # It leaves a log where it is started.
    with tempfile.TemporaryDirectory() as folder:
        told = subprocess.run(["liggghts", "-h"], capture_output=True, text=True, cwd=folder).stdout
    return next((word for word in told.split() if word[0].isdigit()), "").rstrip(",")


def solve(scene, *, n=None) -> Found:
    """Conductivity of a bed by its contacts; the law that a scene names is what it is held against."""
    if not isinstance(scene, beds.Scene):
        raise NotImplementedError("LIGGGHTS conducts between grains that touch: no body, no matrix")
    bed = scene.drawn(n)._replace(law=LAW)
    step, count = beds.march(bed)
    with tempfile.TemporaryDirectory() as folder:
        kinds = _write(Path(folder), bed, step, count)
        _, cost = ran(["liggghts", "-in", "in.bed", "-log", "none"], folder=folder)
        grains, contacts = (_last(Path(folder, name)) for name in ("grains.dump", "contacts.dump"))
    heat, apart = _heat(bed, grains), _apart(bed, grains, contacts)
    note = f"heat in and out {abs(np.diff(heat)[0]) / heat[0]:.0e} apart, of contacts from ours {apart:.0e}"
    found = bed.conductivity(float(np.mean(heat)))
    return Found(
        found, cost | {"whole": True}, unknowns=len(bed.radii), iterations=count, note=f"{note}; {kinds} materials"
    )


def _write(folder, bed, step, count):
    """Its input: a data file of grains and a script; the number of its atom types."""
    rows = np.column_stack((bed.solid, ~np.isnan(bed.held)))
    kinds, kind = np.unique(rows, axis=0, return_inverse=True)
    here, wide = np.arange(1, len(bed.radii) + 1), bed.radii.max()
    lines = [
        f"{i} {k + 1} {2 * r!r} {DENSITY} {x!r} {y!r} {z!r}"
        for i, k, r, (x, y, z) in zip(here, kind.ravel(), bed.radii.tolist(), bed.centers.tolist(), strict=True)
    ]
    box = [f"{-wide!r} {side + wide!r} {c}lo {c}hi" for c, side in zip("xyz", bed.size.tolist(), strict=True)]
    head = ["grains", "", f"{len(here)} atoms", f"{len(kinds)} atom types", "", *box, "", "Atoms", ""]
    (folder / "bed.data").write_text("\n".join([*map(str, head), *lines, ""]).replace("np.float64", ""))
    store = np.where(kinds[:, 1] > 0, HELD, 1.0) * beds.STORED / DENSITY
    hot, cold = (" ".join(map(str, here[bed.held == level])) for level in (1.0, 0.0))
    script = SCRIPT.format(
        number=len(kinds),
        young=_all(kinds, 1e7),
        poisson=_all(kinds, 0.3),
        pairs=_all(np.outer(kinds[:, 0], kinds[:, 0]).ravel(), 0.5),
        conductivity=" ".join(f"{float(k)!r}" for k in kinds[:, 0]),
        capacity=" ".join(f"{float(c)!r}" for c in store),
        hot=hot,
        cold=cold,
        step=step,
        count=count,
        skin=0.01 * wide,
    )
    (folder / "in.bed").write_text(script)
    return len(kinds)


def _all(kinds, value):
    return " ".join([str(value)] * len(kinds))


SCRIPT = """
atom_style granular
boundary f f f
newton off
communicate single vel yes
units si
read_data bed.data
neighbor {skin} bin
neigh_modify delay 1000000000 check no
fix m1 all property/global youngsModulus peratomtype {young}
fix m2 all property/global poissonsRatio peratomtype {poisson}
fix m3 all property/global coefficientRestitution peratomtypepair {number} {pairs}
fix m4 all property/global coefficientFriction peratomtypepair {number} {pairs}
fix m5 all property/global thermalConductivity peratomtype {conductivity}
fix m6 all property/global thermalCapacity peratomtype {capacity}
pair_style gran model hertz tangential off
pair_coeff * *
timestep {step!r}
group hot id {hot}
group cold id {cold}
fix heat all heat/gran/conduction initial_temperature 0.0
run 0
set group hot property/atom Temp 1.0
compute contacts all pair/gran/local id heatFlux contactArea
thermo 1000000
dump grains all custom {count} grains.dump id f_Temp[0] f_heatFlux[0]
dump_modify grains sort id format "%d %.17g %.17g"
dump contacts all local {count} contacts.dump c_contacts[1] c_contacts[2] c_contacts[4] c_contacts[5]
dump_modify contacts format "%.17g %.17g %.17g %.17g"
run {count}
"""


def _last(path):
    """Last frame of a dump, (m, columns) float array."""
    frame = path.read_text().rsplit("ITEM: TIMESTEP", 1)[1]
    return np.loadtxt(frame.split("ITEM: ")[-1].splitlines()[1:], ndmin=2)


def _heat(bed, grains):
    """Heat that the hot grains give and the cold ones take, W."""
    received = grains[:, 2]
    return [float(-received[bed.held == 1.0].sum()), float(received[bed.held == 0.0].sum())]


def _apart(bed, grains, contacts):
    """Largest difference of the heat of a contact from ours at the same temperatures, over the largest heat."""
    ours, _ = beds.flows(bed, grains[:, 1])
    pairs = np.sort(contacts[:, :2].astype(int) - 1, axis=1)
    if set(map(tuple, pairs.tolist())) != set(ours):
        raise RuntimeError(f"LIGGGHTS found {len(pairs)} contacts, not the {len(ours)} of the bed")
    theirs, same = np.abs(contacts[:, 3]), np.abs([ours[pair] for pair in map(tuple, pairs.tolist())])
    return float(np.max(np.abs(theirs - same)) / same.max())
