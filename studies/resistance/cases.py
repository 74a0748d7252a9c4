"""What the study looks at; light, since every listing of studies loads it."""

CONTRAST, FRACTION = 10.0, 0.2
LENGTHS = (0.0, 0.5, 0.9, 10.0)
KNOWING = ("dem", "fem", "fft")
ARRAY = {"dem": (3_000, 30_000, 100_000), "fem": (1 / 8, 1 / 16, 1 / 24), "fft": (32, 64, 128)}
# Voxels have surfaces smeared over one of them: from hardly resisting to nearly a pore.
MORE = {"fft": (0.05, 20.0)}
# Spheres of the neutral dispersions, and what is spent on them.
NEUTRAL = {
    8: {"dem": (10_000,), "fem": (1 / 8,), "fft": (64,), "multipole": (None,)},
    83: {"dem": (100_000,), "fem": (1 / 24,), "fft": (128,), "multipole": (None,)},
}
FRACTIONS = (0.1, 0.2, 0.3, 0.5)
SILICA = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5)
REALISATIONS = (0, 1, 2)
# What the papers' models are above experiment; a usual order of resistances between solids, m2 K/W.
GAP, USUAL = 0.07, 1e-8
