"""The cell of 83 spheres, and what is counted in a field."""

from studies.common import silica_epoxy

FRACTION = 0.2


def spheres():
    """A periodic cell, a fifth of it spheres."""
    return silica_epoxy.scene("periodic", FRACTION, seed=0)


def inside(field):
    """Particles whose centres lie in inclusions, twins among them."""
    return int((field.samples.phase > 0).sum())
