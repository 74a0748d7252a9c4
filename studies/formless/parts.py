"""What the scenes are called, and which contrasts and fractions they have."""

LABYRINTHS = ("primitive", "diamond", "gyroid")
BOARDS = ("checkerboard", "random checkerboard")
FRACTIONS, HALF = (0.1, 0.3, 0.5, 0.7, 0.9), 0.5
BAD, GOOD = 0.01, 100.0
# Of checkerboards: contrasts, and sizes of bricks, in edges.
CHECKERED, BRICKS = (BAD, 10.0, GOOD), (1 / 16, 1 / 32)
