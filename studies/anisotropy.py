"""Conductivities that differ with direction: the whole tensor by finite elements and voxels, beside what is exact.

Periodic cells under loads along x, y and z. A homogeneous one, whose tensor is its own; three layers, in closed form;
and a sphere of one rotated orthotropic material in another, for which there is no closed form: there the two families
are compared with each other, and with Voigt's and Reuss's bounds as matrices, which are certain. Errors are Frobenius
norms over that of the exact tensor. A two-point law of the DEM is consistent only where every facet's normal is a
principal axis, so it refuses, as all other methods do.
"""

import numpy as np

from demheat.scene import Layer, Material, Scene, Sphere, orthotropic
from demheat.tensor import conductivity_tensor
from studies.harness import methods
from studies.harness.cost import measured
from studies.harness.pick import pick

ONE, OTHER = orthotropic(1.0, 4.0, 9.0, rotation=(0.3, -0.5, 0.8)), orthotropic(3.0, 1.0, 0.2, rotation=(1.0, 0.0, 2.0))
BODIES = ("homogeneous", "layers", "sphere")
EDGES, VOXELS = (1 / 6, 1 / 10, 1 / 16), (16, 32, 64)
KNOBS = {
    "fem": {"method": "fem", "order": 2},
    "fem-p1": {"method": "fem", "order": 1},
    "fft": {"method": "fft", "rule": "laminate"},
    "fft-plain": {"method": "fft", "rule": "plain"},
}
# How far the sphere's tensors are to be from the best one's at most, %, coarse and at the finest.
APART = {"fft": (0.3, 0.1), "fem-p1": (3.0, 2.5)}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "homogeneous": "rounding: sums over some 1e5 elements may lose four digits of sixteen",
    "layers": "equations are iterated to 1e-8 of the heat; the conductivity errs by less, as its square or by luck",
    "symmetric": "loads are iterated one by one to 1e-8, and entries between two of them have no square",
}
# Entries of a symmetric tensor.
ENTRIES = ("xx", "yy", "zz", "yz", "xz", "xy")


def _cases():
    for body in BODIES:
        for name, knobs in KNOBS.items():
            values = EDGES if knobs["method"] == "fem" else VOXELS
            column = "edge" if knobs["method"] == "fem" else "voxels"
            # What is exact on any mesh is so on the coarsest.
            kept = values if body == "sphere" or name == "fft-plain" else values[:1]
            yield from ({"body": body, "name": name, column: value, **knobs} for value in kept)


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """The two coarsest of each."""
    return case.get("edge", 1.0) > EDGES[2] if case["method"] == "fem" else case["voxels"] < VOXELS[2]


def scene_of(body) -> Scene:
    """One of the bodies, under a load along x."""
    one, other = Material(ONE), Material(OTHER)
    shapes = {
        "homogeneous": [],
        "layers": [Layer(1, 0.13, 0.41, other), Layer(1, 0.6, 0.75, Material(2.0))],
        "sphere": [Sphere((0.45, 0.5, 0.6), 0.3, other)],
    }
    return Scene((1.0, 1.0, 1.0), one, shapes[body], gradient=(1.0, 0.0, 0.0))


def run(body, name, method, edge=None, voxels=None, **knobs):
    """The tensor that a method finds; how far it is from the exact one, from its transpose and from the bounds."""
    scene, module = scene_of(body), methods.load(method)
    knobs |= {"size": edge} if method == "fem" else {"voxels": voxels}
    fields, cost = measured(module.solve_axes, scene, **knobs)
    found = conductivity_tensor(fields)
    scale, fractions = np.linalg.norm(found), fields[0].fractions
    voigt = np.einsum("p,pij->ij", fractions, scene.tensors)
    reuss = np.linalg.inv(np.einsum("p,pij->ij", fractions, np.linalg.inv(scene.tensors)))
    row = {f"k_{entry}": found["xyz".index(entry[0]), "xyz".index(entry[1])] for entry in ENTRIES}
    row |= {
        "error_percent": _error_percent(body, scene, found),
        "asymmetry": np.linalg.norm(found - found.T) / scale,
        "least": np.linalg.eigvalsh((found + found.T) / 2)[0],
        "below_voigt": np.linalg.eigvalsh(voigt - found)[0] / scale,
        "above_reuss": np.linalg.eigvalsh(found - reuss)[0] / scale,
    }
    return row | {stat: fields[0].stats[stat] for stat in ("unknowns", "iterations", "residual")} | cost


def _error_percent(body, scene, found):
    if body == "sphere":
        return None
    right = conductivity_tensor(methods.load("exact").solve_axes(scene))
    return 100 * np.linalg.norm(found - right) / np.linalg.norm(right)


def tensor_of(row):
    """The tensor of a row, (3, 3) float array, W/(m K)."""
    xx, yy, zz, yz, xz, xy = (row[f"k_{entry}"] for entry in ENTRIES)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def apart_percent(row, reference):
    """How far the tensor of a row is from that of another, Frobenius norms, %."""
    right = tensor_of(reference)
    return 100 * np.linalg.norm(tensor_of(row) - right) / np.linalg.norm(right)


def claims(df):
    """What is exact is so to the equations' tolerance; what is not lies between the bounds and comes together.

    Limits were set before the rows; that of the sphere after a first look at another sphere, where .01 % were apart.
    All were brought nearer when the values were known: from 1e-7 and 1e-6 % of what is exact, 1e-5 of the symmetry and
    .3 and 3 % of the sphere.
    """
    yield from [*_exact(df), *_sphere(df)]


def _exact(df):
    for name in KNOBS:
        off = pick(df, body="homogeneous", name=name)["error_percent"].max(skipna=False)
        yield f"homogeneous, {name}: error of the tensor, %", off, 1e-10
    for name in ("fem", "fem-p1", "fft"):
        off = pick(df, body="layers", name=name)["error_percent"].max(skipna=False)
        yield f"layers, {name}: error of the tensor, %", off, 1e-8
    yield "all: largest part of a tensor that is not symmetric", df["asymmetry"].max(skipna=False), 1e-6


def _sphere(df):
    rows = pick(df, body="sphere")
    for side in ("below_voigt", "above_reuss"):
        yield f"sphere: {side.replace('_', ' ')}, least eigenvalue over the norm", rows[side].min(skipna=False), "> 0"
    best = _finest(pick(rows, name="fem"))
    whole = "voxels" in rows and (rows["voxels"] == VOXELS[-1]).any()
    for name, (coarse, fine) in APART.items():
        other = _finest(pick(rows, name=name))
        if best is not None and other is not None:
            off = apart_percent(other, best)
            limit = fine if whole else coarse
            yield f"sphere: {name} from quadratic elements, both at their finest, %", off, limit


def _finest(rows):
    """The row with the most unknowns, if there is one."""
    return rows.loc[rows["unknowns"].idxmax()] if len(rows) else None


def table(df):
    """Tensors in W/(m K), their error where there is an exact one, and what they lack of being symmetric."""
    columns = ["body", "name", "edge", "voxels", *(f"k_{entry}" for entry in ENTRIES)]
    return df[[*columns, "error_percent", "asymmetry", "unknowns"]]


def plot(df):
    """Distance of the sphere's tensor from that of the finest quadratic elements."""
    from matplotlib import pyplot

    from studies.harness.figures import look

    figure, axes = pyplot.subplots(figsize=(6.5, 4.8))
    rows = pick(df, body="sphere")
    best = _finest(pick(rows, name="fem"))
    axes.grid(visible=True, which="both", axis="y")
    for name, group in rows.groupby("name", sort=False):
        group = group.sort_values("unknowns")
        off = np.array([apart_percent(row, best) for _, row in group.iterrows()])
        # The finest elements are what others are compared with.
        axes.plot(group["unknowns"][off > 0], off[off > 0], **look(name))
    axes.set(xscale="log", yscale="log", xlabel="unknowns", ylabel="tensor apart from finest quadratic elements, %")
    near = [f"{_words(name)} {apart_percent(_finest(pick(rows, name=name)), best):.2g} %" for name in ("fft", "fem-p1")]
    figure.suptitle("A sphere of one orthotropic material in another, at the finest:")
    axes.set_title(f"{' and '.join(near)} from quadratic elements")
    axes.legend()
    return figure


def _words(name):
    return methods.all_methods()[name].title
