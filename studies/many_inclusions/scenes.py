"""The cell of 83 spheres and a denser one whose spheres nearly touch, and what is counted in a field."""

from studies.common import silica_epoxy

FRACTION, CLOSE = 0.2, 0.3


def spheres(gap=None):
    """A periodic cell, a fifth of it spheres; with a least gap, in diameters, one of 124 spheres."""
    if gap is None:
        return silica_epoxy.scene("periodic", FRACTION, seed=0)
    return silica_epoxy.scene("periodic", CLOSE, seed=0, gap=gap)


def inside(field):
    """Particles whose centres lie in inclusions, twins among them."""
    return int((field.samples.phase > 0).sum())
