"""Which scenes, factors and packings the study of tuning spends its time on."""

from studies.tuning.scenes import FAMILIES, MESHED

# Particles, and how many scenes of each family they are spent on.
SCENES = {2_000: 3, 8_000: 3, 30_000: 2, 100_000: 1}
# Seeds of the scenes: the first, and the one after the last. Nothing was chosen on them.
GROUPS = {"unseen": (200, 203)}
# Factors of each constant: of the five that shape every layer of twins some at more particles too.
MAIN = {
    "OFFSET": (0.7, 0.85, 1.4),
    "BEND": (0.0, 0.7, 1.4),
    "SPACING": (0.7, 1.4),
    "MARGIN": (0.372, 1.4, 2.0),  # the first is that with the other sign of EXCESS
    "NARROW": (0.7, 0.85, 1.2),
}
OTHERS = {
    "EXCESS": (0.7, 1.4),
    "LESS": (0.0, 2.0),
    "GAP_SPACING": (0.5,),
    "THINNING": (0.7, 1.3),
    "LEAST_OFFSET": (0.5, 2.0),
}
FINE = {8_000: (0.0, 0.7, 0.85, 1.2, 1.4), 30_000: (0.0, 0.7, 0.85, 1.2, 1.4), 100_000: (0.7, 0.85, 1.2)}
# Held against tiles and twins as they are.
OLD = ("RELAXED", "BEFORE")
# Elements know these families to some 1e-5: too little beside the finest packings.
MOST_MESHED = 8_000
# Of the order: packings of each number of particles, and what is varied.
PACKINGS = {1_000: 8, 2_000: 8, 4_000: 8, 8_000: 8, 16_000: 6, 32_000: 4, 100_000: 3}
COARSE = (1_000, 4_000, 16_000)
SPHERE = {"shape": "sphere", "contrast": 10.0, "constant": None, "factor": 1.0}
UNBENT = SPHERE | {"constant": "BEND", "factor": 0.0}
NEARER, OTHER_SIGN = ({"constant": "OFFSET", "factor": 0.7}, {"constant": "MARGIN", "factor": 0.372})
PROBES = (SPHERE, UNBENT, *(SPHERE | {"contrast": contrast} for contrast in (0.01, 1.01)))
PROBES = (*PROBES, SPHERE | NEARER, SPHERE | OTHER_SIGN)


def _varied(constant, factor, particles):
    return {
        "part": "varied",
        "group": "unseen",
        "constant": constant,
        "factor": factor,
        "particles": particles,
        "method": "dem",
    }


def cases():
    """All cases, in order."""
    for family in FAMILIES:
        yield {"part": "reference", "group": "unseen", "family": family, "method": _witness(family)}
    for particles in SCENES:
        yield _varied(None, 1.0, particles)
        yield from (_varied(old, 1.0, particles) for old in OLD)
        for constant, factors in (MAIN if particles in FINE else MAIN | OTHERS).items():
            allowed = FINE.get(particles, factors)
            yield from (_varied(constant, factor, particles) for factor in factors if factor in allowed)
    for probe in PROBES:
        for particles in PACKINGS if probe == SPHERE else COARSE:
            yield {"part": "order", **probe, "particles": particles, "method": "dem"}
    yield {"part": "order", **SPHERE, "shape": "layer", "particles": 1_000, "method": "dem"}


def _witness(family):
    return "fem" if family in MESHED else "multipole"
