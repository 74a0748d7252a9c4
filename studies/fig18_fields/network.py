"""Rows of the paper's network among many spheres: its flux is that of the particles, averaged over halos."""

from studies.common import paper_network
from studies.fig18_fields.rows import looked, spheres_in

# Halo, in mean radii (eqs. 22-23).
RATIO = 11.0


def _boundary(held):
    return "gradient" if held == "periodic" else "walls"


def network_row(held, *, fine=False, **case):
    """Solve, and keep temperature and flux at the points and over the plane, with C_t = 1."""
    from demheat.sampling.halo import halo_flux

    boundary = _boundary(held)
    fields, row = paper_network.fields_and_row({"k": spheres_in(boundary)}, held=held, **case)
    field = fields["k"]
    factor = field.stats["calibration"]
    found = looked(field, boundary, lambda points: halo_flux(field, ratio=RATIO, at=points) / factor, fine=fine)
    return row | {"under": boundary} | found | {"mean_flux": found["mean_flux"] / factor}
