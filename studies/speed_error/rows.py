"""What a row computes: a solve and what it costs, the DEM's from an empty packing cache and then again."""

import tempfile
import warnings

from demheat.gallery import HADDAD
from references import exact, multipole
from studies.common.steady_scenes import STEADY
from studies.harness import methods

# What a second solve, whose packing is kept already, costs.
AGAIN = ("wall_s", "cpu_s", "peak_mib")
# Relative error of what is taken for true.
ACCURACY = 1e-7


def solved(name, *, method, **knobs):
    """Solve a scene by a method, the DEM from an empty packing cache and then again."""
    scene = STEADY[name]()
    ratio = _exact(scene) / HADDAD.conductivity
    with warnings.catch_warnings():
        # What coarse particles and voxels do not resolve is what the errors show.
        warnings.filterwarnings("ignore", message=".*(do not fit into gaps|no particle lies|thin|narrow|miss them)")
        if "particles" not in knobs:
            return methods.solved(scene, ratio, method=method, **knobs)[1]
        with tempfile.TemporaryDirectory() as folder, methods.packings_in(folder):
            cold, again = (methods.solved(scene, ratio, method=method, **knobs)[1] for _ in range(2))
    return cold | {f"cached_{key}": again[key] for key in AGAIN}


def _exact(scene):
    try:
        return exact.solve(scene).conductivity
    except NotImplementedError:
        return multipole.solve(scene, accuracy=ACCURACY).conductivity
