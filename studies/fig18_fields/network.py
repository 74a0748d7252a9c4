"""Rows of the paper's network among many spheres: its flux is that of the particles, averaged over halos."""

from __future__ import annotations

from studies.common import paper_network, silica_epoxy
from studies.fig18_fields.rows import looked, spheres_in

# Halo, in mean radii (eqs. 22-23).
RATIO = 11.0


def network_row(packing, held, particles, seed, replicas=1, *, fine=False):
    """Solve, and keep temperature and flux at the points and over the plane, with C_t = 1.

    Parameters
    ----------
    packing, held, particles, seed, replicas
        Of a case, see `paper_network`.
    fine : bool
        Keep pictures of many pixels, too.

    Returns
    -------
    dict
        With `under`, its boundary condition.
    """
    from demheat.sampling.halo import halo_flux

    boundary = "gradient" if held == "periodic" else "walls"
    scene = spheres_in(boundary)
    made = paper_network.packed(scene.size, packing, held, particles, seed, replicas)
    fields, row = paper_network.solved({"k": scene}, made, held, replicas)
    field = fields["k"]
    row |= {"under": boundary, "k": paper_network.unscaled(field, silica_epoxy.EPOXY.conductivity)}
    factor = field.stats["calibration"]
    found = looked(field, boundary, lambda points: halo_flux(field, ratio=RATIO, at=points) / factor, fine=fine)
    return row | found | {"mean_flux": found["mean_flux"] / factor}


def warm_up(packing, held, particles, seed, replicas=1):
    """Make the dispersion and the packing, load and compile, also what looks at halos.

    Parameters
    ----------
    packing, held, particles, seed, replicas
        Of a case.
    """
    scene = spheres_in("gradient" if held == "periodic" else "walls")
    paper_network.packed(scene.size, packing, held, particles, seed, replicas)
    paper_network.warm_up(held)
