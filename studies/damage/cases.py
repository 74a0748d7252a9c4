"""What the study looks at; light, since every listing of studies loads it."""

# Equal spheres of silica in epoxy, a fifth of the volume; shares of them that have come off.
SPHERES, FRACTION = 16, 0.2
SHARES = (0.0, 0.5, 1.0)
# Resolutions, the coarsest first; lengths in edges of the cube.
DEBONDED = {"dem": (10_000, 100_000), "fem": (1 / 8, 1 / 16), "fft": (32, 96), "multipole": (None,)}
# Radii of discs, in edges of the cell, and particles.
RADII = (0.1, 0.2, 0.3, 0.4)
CRACKED = (1_000, 8_000, 64_000)
# Links that are gone; cells of the lattice along each edge, and particles of the packing; draws.
REMOVED = (0.01, 0.1, 0.2, 0.4, 0.6, 0.65, 0.7, 0.85)
LATTICE, PACKED = (12, 32), (2_000, 30_000)
DRAWS = (0, 1, 2)
# Neighbours on the simple cubic lattice, and the share of links that it needs to conduct: Wang et al., Phys. Rev. E 87
# (2013) 052107.
NEIGHBOURS, THRESHOLD = 6, 0.24881
