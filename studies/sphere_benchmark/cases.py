"""What the study spends its time on: light, since every listing of studies loads it."""

# Where a case's method is not one of ours; see `guests`.
GUEST = "guest"
# The column of the knob, and its values; lengths in edges of the box.
LADDERS = {
    "dem": ("particles", (2_000, 20_000)),
    "fem": ("size", (0.2, 0.1)),
    "fft": ("voxels", (32, 64)),
    "multipole": ("degree", (7,)),
    "maxwell": (None, (None,)),
}
# Around the most spheres elements are dearest; iterations on voxels beside pores are dear.
MOST = ("dispersion-150", "dispersion-83")
POROUS = ("sc-third-pore", "coated-hollow", "dispersion-20-pores")
RELATIONS = ("uniform", "scaled", "reversed", "turned", "tenfold")
