"""What two grains that meet in a disc conduct as a continuum: the axially symmetric cell of one of a row of them.

Grains of radius 1 are cut where they meet, so that they share discs of radius a; beside them is a medium, or nothing,
out to a cylinder. Planes through middles and contacts are isothermal, the cylinder is insulated. Bilinear elements on a
grid like that of oblate spheroids around the disc, in whose coordinates the field at its rim is smooth: the surface is
a line of it, as is the plane through the middle.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve

GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)


def conductance(contact, solid, medium=0.0, *, width=1.05, lines=80) -> float:
    """Conductance from middle to middle over the radius, in units of the conductivities.

    By 40, 80 and 160 lines it changes by a fifth of a per cent at most, contacts from 0.05 to 0.3.
    """
    rho, z = _grid(contact, width, lines)
    matrix = _assembled(rho, z, np.where(np.arange(2 * lines) < lines, solid, medium))
    temperature, free = np.zeros(rho.shape), np.zeros(rho.shape, bool)
    temperature[0] = 1.0
    # Without a medium nodes beyond the surface have no equation.
    free[1:-1, : None if medium > 0 else lines + 1] = True
    free, level = free.ravel(), temperature.ravel()
    level[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ level)[free])
    # Half a cell, from the middle to the plane of contact; two are in series.
    return 0.5 * float(level @ (matrix @ level))


def _grid(contact, width, lines):
    """Places of nodes: rows from the plane of contact down to the middle, columns from the axis out."""
    t, height = np.linspace(0.0, 1.0, lines + 1), np.sqrt(1.0 - contact**2)
    # Where each row meets the surface, and how far below the disc it begins on the axis.
    reach = np.minimum(contact * np.cosh(np.arccosh(1.0 / contact) * t), 1.0)[:, None]
    level, depth = np.sqrt(1.0 - reach**2), np.sqrt(np.maximum(reach**2 - contact**2, 0.0))
    turn = 0.5 * np.pi * t
    within = height - depth * np.cos(turn) - (height - level) * (1.0 - np.cos(turn))
    rho = np.hstack((reach * np.sin(turn), reach * (width / reach) ** t[1:]))
    return rho, np.hstack((within, np.broadcast_to(level, (lines + 1, lines))))


def _assembled(rho, z, k):
    """Matrix of the energy, the integral of k |grad T|^2 over the volume."""
    number = np.arange(rho.size).reshape(rho.shape)
    corners = np.stack([each.ravel() for each in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])])
    places = np.stack((rho.ravel()[corners], z.ravel()[corners]))
    weight, total = np.tile(k, rho.shape[0] - 1), np.zeros((4, 4, corners.shape[1]))
    for x in GAUSS:
        for y in GAUSS:
            shape = np.array([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)]) / 4
            slope = np.array([[y - 1, 1 - y, 1 + y, -1 - y], [x - 1, -1 - x, 1 + x, 1 - x]]) / 4
            turned = np.einsum("an,bne->eab", slope, places)
            size = np.linalg.det(turned)
            slopes = np.linalg.solve(turned, np.broadcast_to(slope, (len(size), 2, 4)))
            volume = 2.0 * np.pi * (shape @ places[0]) * np.abs(size) * weight
            total += np.einsum("e,ean,eam->nme", volume, slopes, slopes)
    rows = np.broadcast_to(corners[:, None], total.shape)
    columns = np.broadcast_to(corners[None], total.shape)
    return sparse.csr_matrix((total.ravel(), (rows.ravel(), columns.ravel())), shape=(rho.size, rho.size))
