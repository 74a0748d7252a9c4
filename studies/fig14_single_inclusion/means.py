"""What is printed of the sphere in a cube, its scenes in words, and what is exact of them."""

from studies.harness.pick import pick
from studies.harness.store import printed

PAPER = printed("fig14_single_inclusion")
CONTRASTS = (0.01, 0.1, 10.0, 100.0)
SCENES = [*(("third", contrast) for contrast in CONTRASTS), ("half", 10.0)]
# Contrasts of the paper's figure, as columns of the network's rows end.
WORDS = tuple(f"{contrast:g}" for contrast in CONTRASTS)


def label(scene, contrast):
    """Scene in a word, as columns of the network's rows end.

    Parameters
    ----------
    scene : {"third", "half"}
    contrast : float
    """
    return f"{contrast:g}" if scene == "third" else scene


def exact_of(df, name="exact"):
    """k over the matrix's by a method without resolution, by the labels of the network's scenes.

    Parameters
    ----------
    df : data frame
    name : {"exact", "maxwell"}
    """
    found = {label(*where): pick(df, name=name, scene=where[0], contrast=where[1])["k_ratio"] for where in SCENES}
    return {where: float(values.iloc[0]) for where, values in found.items() if len(values)}
