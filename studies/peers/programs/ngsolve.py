"""NGSolve: finite elements of any order on curved tetrahedra, the body drawn and meshed by itself.

Its OpenCASCADE draws the scene, Netgen meshes it (its defaults but for the longest edge), elements bend to the
polynomials' order, and conjugate gradients preconditioned by the diagonal go down to 1e-10: up to 150 000 unknowns that
took the least CPU time of what NGSolve has (multigrid, BDDC, sparse Cholesky), without threads, which cost more CPU
time than they saved. From order 3 on what is inside elements is condensed. The conductivity is twice the energy.
Meshing is told not to use threads either, whose waiting took ten times the CPU time of the meshing.
https://ngsolve.org, version 6.2.2608. Its documentation prints no value of a solid whose conduction is known: no `own`.
"""

from functools import singledispatch

from demheat.scene import Layer, Shape, Sphere
from studies.peers import packages
from studies.peers.given import bodies

TITLE = "NGSolve"
KIND = "body"
GET = "pip: ngsolve"
CANNOT = {"other shapes": "only spheres and layers are drawn here, though its OpenCASCADE knows more"}
EXPLAINED = "half 10: elements that bend into the gap at the walls, 0.008 of the edge, fold above an edge of 0.06"
SCENES = bodies("layers across", "layers along")
# Edges, in those of the cube, by order: few high elements, or many low ones.
SIZES = {2: (0.2, 0.1, 0.06), 3: (0.2, 0.1, 0.06), 5: (0.2, 0.1)}
CASES = tuple(
    {"scene": scene, "order": order, "size": size}
    for scene in SCENES
    for order, sizes in SIZES.items()
    for size in sizes
)
missing, version = packages.asked_of("ngsolve", GET)


def solve(scene, *, size, order=2):
    """Draw, mesh and solve a body."""
    note = "{elements} tetrahedra in {meshed[cpu_s]:.2f} s, {folded} folded"
    return packages.found("ngsolve", asked_for(scene) | {"size": size, "order": order}, note=note)


def asked_for(scene) -> dict:
    """A body as what JSON can hold."""
    parts = [{"kind": "box", "conductivity": scene.matrix.conductivity}]
    parts += [part(shape) | {"conductivity": shape.material.conductivity} for shape in scene.inclusions]
    return {"box": list(scene.size), "walls": dict(scene.wall_temperatures), "parts": parts}


@singledispatch
def part(shape: Shape) -> dict:
    """Kind and lengths of a shape."""
    raise NotImplementedError(f"{shape.kind} are not drawn here, only spheres and layers")


@part.register
def _(shape: Sphere):
    return {"kind": "sphere", "center": list(shape.center), "radius": shape.radius}


@part.register
def _(shape: Layer):
    return {"kind": "layer", "axis": shape.axis, "start": shape.start, "stop": shape.stop}
