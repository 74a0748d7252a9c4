"""What the study looks at, and its limits; light, since every listing of studies loads it."""

# Coarse and fine: particles, voxels along an edge, element sizes in edges; a small body asks for more.
SPENT = {"dem": (3_000, 30_000), "fft": (32, 64), "fem": (1 / 8, 1 / 16)}
# Of elements a sixth was to be the finest; from there on the ellipsoid's own surface sets theirs, down to some 1/25.
SPENT_ON_ELLIPSOID = {"dem": (20_000, 100_000), "fft": (64, 96), "fem": (1 / 6, 1 / 45)}
CONTRASTS, FRACTIONS = (0.01, 0.1, 10.0, 100.0), (0.3, 0.6)
# The fibre whose temperature is looked at, too.
CONTRAST, FRACTION = 10.0, 0.3
# Contrasts of each part besides fibres, and the methods that take it: voxels knew no resistance, FEM no level set.
PARTS = {
    "neutral fibre": ((CONTRAST,), ("dem", "fem")),
    "square rods": ((0.1, 10.0), tuple(SPENT)),
    "diagonal": ((4.0, 10.0), tuple(SPENT)),
    "sphere": ((CONTRAST,), tuple(SPENT)),
    "level set": ((CONTRAST,), ("dem", "fft")),
    "ellipsoid": ((CONTRAST,), tuple(SPENT)),
    "capped rod": ((CONTRAST,), tuple(SPENT)),
}
BALLS, FEW = 0.2, 0.002
# Fields beside edges that a smooth surface has not.
SINGULAR = ("square rods", "diagonal", "capped rod")

# Largest error of the conductivity, %, coarse and fine, of rows of a part at some contrasts.
LIMITS = (
    ("fibres", (0.1, 10.0), {"dem": (0.035, 0.0025), "fft": (0.15, 0.07), "fem": (0.07, 0.012)}),
    ("fibres", (0.01, 100.0), {"dem": (0.07, 0.005), "fft": (2.0, 0.6), "fem": (0.1, 0.02)}),
    ("neutral fibre", (10.0,), {"dem": (0.035, 0.007), "fem": (5e-4, 7e-5)}),
    ("square rods", (0.1, 10.0), {"dem": (0.4, 0.12), "fft": (0.003, 4e-4), "fem": (0.7, 0.3)}),
    ("diagonal", (4.0,), {"dem": (0.15, 0.13), "fft": (0.004, 8e-4), "fem": (0.6, 0.3)}),
    ("diagonal", (10.0,), {"dem": (2.3, 2.4), "fft": (0.25, 0.09), "fem": (5.0, 3.0)}),
    ("sphere", (10.0,), {"dem": (0.018, 0.013), "fft": (0.18, 0.07), "fem": (0.25, 0.025)}),
    ("level set", (10.0,), {"dem": (0.035, 0.013), "fft": (0.18, 0.07)}),
)
# Of the temperature's root mean square, % of the span.
WARMTH = {"dem": (0.016, 0.0026), "fft": (0.11, 0.05), "fem": (0.09, 0.02)}
# Of the ellipsoid's tensor, % of what it adds to the matrix's; that of the finest elements is the theory's own.
ADDED = {"dem": (1.0, 0.3), "fft": (2.4, 1.1), "fem": (0.7, None)}
