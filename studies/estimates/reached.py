"""What `demheat.effective` says of a drawn scene at an accuracy, beside the exact tensor."""

import numpy as np

import demheat.cheapest
from demheat.tensor import conductivity_tensor
from references import exact, multipole
from studies.common.drawn import ACCURACY, CLOSED, scene_of
from studies.estimates.rows import MODULES

# Those that approximate: witnesses are not judged by themselves.
METHODS = tuple(name for name in MODULES if name != "multipole")


def answered(kind, seed, accuracy):
    """Answer for one scene."""
    scene = scene_of(kind, seed)
    judge = exact.solve_axes(scene) if kind in CLOSED else multipole.solve_axes(scene, accuracy=ACCURACY)
    right = conductivity_tensor(judge)
    try:
        found = demheat.cheapest.effective(scene, accuracy=accuracy, method=METHODS)
    except RuntimeError as error:
        return {"status": "unsupported", "note": " ".join(str(error).split())}
    scale = float(np.trace(right)) / 3
    off = np.abs(found.tensor - right) / (scale or 1.0)
    slack = ACCURACY * scale
    inside = (found.lower - slack <= right) & (right <= found.upper + slack)
    return {
        "name": found.method,
        "worst_percent": 100 * float(np.max(off)),
        "said_percent": 100 * found.accuracy,
        "inside": bool(np.all(inside)),
        "rounds": found.cost["rounds"],
        "cpu_s": found.cost["cpu_s"],
        "saved": "; ".join(found.saved),
    }
