"""Compiled loops in pieces of well under a second, between which the interpreter hears an interrupt."""

# Seconds that a piece takes, about.
PIECE = 0.3


def in_pieces(team, kernel, planes, cost, *arguments):
    """Call kernel(*arguments, low, high) on chunks that make up range(planes)."""
    most = max(1, int(PIECE * team.threads / cost))
    for first in range(0, planes, most):

        def piece(low, high, first=first):
            kernel(*arguments, first + low, first + high)

        team.run(piece, min(most, planes - first))
