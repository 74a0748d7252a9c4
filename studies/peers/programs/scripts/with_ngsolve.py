"""A body in NGSolve: drawn with its OpenCASCADE, meshed with Netgen, solved with finite elements of any order.

Reads one JSON object: `box` (m), `parts` (each with `kind`, its lengths in m and a `conductivity`, the matrix first;
a later one lies in those before it), `walls` (K across x), `size` (longest edge), `order`; prints another.
"""

import json
import sys

import ngsolve as ng
from netgen.meshing import MeshingParameters
from netgen.occ import Box, Glue, OCCGeometry, Pnt, Sphere
from spent import Spent

TOLERANCE, MOST = 1e-10, 5000
NEAR = 1e-9


def _solid(part, box):
    """Solid of a part, cut to the box."""
    if part["kind"] == "sphere":
        return Sphere(Pnt(*part["center"]), part["radius"]) * Box(Pnt(0, 0, 0), Pnt(*box))
    low, high = [0.0, 0.0, 0.0], list(box)
    if part["kind"] == "layer":
        low[part["axis"]], high[part["axis"]] = max(part["start"], 0.0), min(part["stop"], box[part["axis"]])
    return Box(Pnt(*low), Pnt(*high))


def _drawn(box, parts):
    """Geometry whose solids are named by the number of their part; what does not conduct is left out."""
    pieces, later = [], None
    for number, part in reversed(list(enumerate(parts))):
        whole = _solid(part, box)
        if part["conductivity"] > 0:
            piece = whole if later is None else whole - later
            piece.mat(str(number))
            pieces.append(piece)
        later = whole if later is None else later + whole
    shape = Glue(pieces) if len(pieces) > 1 else pieces[0]
    for face in shape.faces:
        for name, at in (("low", 0.0), ("high", box[0])):
            if all(abs(corner.p.x - at) < NEAR for corner in face.vertices) and abs(face.center.x - at) < NEAR:
                face.name = name
    return OCCGeometry(shape)


def _solved(mesh, values, walls, order):
    """Temperature by conjugate gradients, the conductivity field, iterations and free unknowns."""
    conductivity = mesh.MaterialCF(values)
    space = ng.H1(mesh, order=order, dirichlet="low|high")
    u, v = space.TnT()
    form = ng.BilinearForm(conductivity * ng.grad(u) * ng.grad(v) * ng.dx, symmetric=True, condense=order > 2)
    preconditioner = ng.Preconditioner(form, "local")
    form.Assemble()
    t = ng.GridFunction(space)
    t.Set(mesh.BoundaryCF({"low": walls["x-"], "high": walls["x+"]}), ng.BND)
    residual = t.vec.CreateVector()
    residual.data = -form.mat * t.vec
    if form.condense:
        residual.data += form.harmonic_extension_trans * residual
    inverse = ng.krylovspace.CGSolver(form.mat, preconditioner.mat, tol=TOLERANCE, maxiter=MOST)
    t.vec.data += inverse * residual
    if form.condense:
        # Nothing else is inside elements that have no sources.
        t.vec.data += form.harmonic_extension * t.vec
    if inverse.iterations >= MOST:
        raise RuntimeError(f"conjugate gradients: not done after {MOST} iterations")
    return t, conductivity, inverse.iterations, sum(space.FreeDofs(False))


def _folded(mesh, order):
    """Number of elements that are inside out at a point, as those may be that bend into a gap."""
    inside_out = ng.IfPos(ng.Det(ng.specialcf.JacobianMatrix(3)), 0.0, 1.0)
    return sum(part != 0.0 for part in ng.Integrate(inside_out, mesh, order=max(10, 2 * order), element_wise=True))


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    ng.SetNumThreads(1)
    order, walls, box = given["order"], given["walls"], given["box"]
    clock = Spent()
    geometry = _drawn(box, given["parts"])
    mesh = ng.Mesh(geometry.GenerateMesh(mp=MeshingParameters(maxh=given["size"], parallel_meshing=False)))
    mesh.Curve(order)
    meshed = clock.so_far()
    values = {str(i): part["conductivity"] for i, part in enumerate(given["parts"]) if part["conductivity"] > 0}
    t, conductivity, iterations, unknowns = _solved(mesh, values, walls, order)
    # Twice the order of the gradients, and what curved elements add.
    power = ng.Integrate(conductivity * ng.grad(t) * ng.grad(t), mesh, order=2 * order + 2)
    found = power / (walls["x-"] - walls["x+"]) ** 2 * box[0] / (box[1] * box[2])
    answer = {"conductivity": found, "iterations": iterations, "unknowns": unknowns, "elements": mesh.ne}
    cost = clock.so_far()
    print(json.dumps({**answer, "meshed": meshed, "cost": cost, "folded": _folded(mesh, order)}))


if __name__ == "__main__":
    main()
