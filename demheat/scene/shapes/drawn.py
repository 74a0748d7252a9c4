"""How a shape is drawn that is known by triangles."""

from typing import NamedTuple


class Drawn(NamedTuple):
    """Its triangles; zeros of a shape that has a formula."""

    area: float = 0.0  # m2
    triangles: int = 0
    sharp: int = 0  # Edges
    reach: float = 0.0  # m: Of the farthest corner from the middle
