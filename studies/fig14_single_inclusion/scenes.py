"""Scenes of the sphere in a cube, and their names."""

from studies.harness import methods

FRACTIONS = {"third": methods.THIRD, "half": methods.HALF}
CONTRASTS = (0.01, 0.1, 10.0, 100.0)
SCENES = [*(("third", contrast) for contrast in CONTRASTS), ("half", 10.0)]
# Contrasts of the paper's figure, as columns of the network's rows end.
WORDS = tuple(f"{contrast:g}" for contrast in CONTRASTS)


def label(scene, contrast):
    """Scene in a word, as columns of the network's rows end."""
    return f"{contrast:g}" if scene == "third" else scene
