"""What is most asked of a scene, in words."""

from collections import Counter


def told_of(scene) -> dict[str, str]:
    """Body, inclusions, conductivities and load of a scene."""
    kinds = Counter(shape.kind for shape in scene.inclusions)
    k = sorted(set(scene.mean_conductivities.tolist()))
    gradient = {"gradient": f"{scene.gradient} K/m, a periodic cell"}
    return {
        "scene": f"{scene.domain} of {' x '.join(f'{side:.6g}' for side in scene.size)} m",
        "inclusions": ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none",
        **({} if scene.image is None else {"image": f"{' x '.join(map(str, scene.image.shape))} voxels"}),
        "conductivities": f"{', '.join(f'{each:.6g}' for each in k[:8])}{', ...' if len(k) > 8 else ''} W/(m K)"
        + (", means over directions" if scene.anisotropic else ""),
        **(gradient if scene.periodic else {"walls": _listed(scene.walls)}),
    }


def _listed(walls):
    return ", ".join(f"{name}: {load}" for name, load in walls.items()) or "insulated"
