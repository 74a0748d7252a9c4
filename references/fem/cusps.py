"""Spheres that no mesh fits around, told before there is one."""

from demheat.scene import Scene
from demheat.scene.inputs import one_line
from references.mesh.sizes import wanted_sizes


def cusp(scene: Scene) -> str:
    """Why spheres cannot be meshed, or nothing; other shapes are measured by the mesher alone, which takes longer."""
    if not all(shape.fills_ball for shape in scene.inclusions):
        return ""
    try:
        wanted_sizes(scene, max(scene.size))
    except (ValueError, NotImplementedError) as error:
        return one_line(error)
    return ""
