"""Rows of the FFT with links cut at interfaces, which its solver takes by itself at high contrast: for the laws alone.

The study compares methods with one rule each. What the package tells of a scene beforehand is of the rule that the
scene gets (`references.fft.rules.automatic`), so that rule needs a law, too. The rows lie beside this file:
`python -m studies run speed_error.links --out FOLDER` makes them anew.
"""

from pathlib import Path

from studies.harness import methods
from studies.speed_error.cases import STEADY, TIMEOUT, VOXELS

__all__ = ["CASES", "FILE", "QUICK", "TIMEOUT", "claims", "plot", "run", "warm_up"]
FILE = Path(__file__).with_name("links.csv")
# Layers get laminates; a thousand spheres cost more than all others together.
LEFT_OUT = ("laminate", "1000 spheres")
SCENES = [scene for scene in STEADY if scene not in LEFT_OUT]
CASES = [methods.case("fft-links", scene=scene, voxels=voxels) for scene in SCENES for voxels in VOXELS]


def QUICK(case):
    """The coarsest."""
    return case["voxels"] == VOXELS[0]


def run(name, scene, method, **knobs):
    """One row, as the study's."""
    from studies.speed_error import rows

    return rows.solved(scene, method=method, **knobs)


def warm_up(name, scene, method, **knobs):
    """Load the solver."""
    from studies.speed_error import rows

    rows.warm_up(scene, method=method, **knobs)


def plot(df):
    """The study's panels."""
    from studies.speed_error.figure import draw

    return draw(df)


def claims(df):
    """None: the laws are judged as those of other methods."""
    return []
