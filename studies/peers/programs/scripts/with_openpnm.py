"""An image in OpenPNM: a pore in each voxel, throats through the faces; or PoreSpy's `tortuosity_fd` on such.

Reads one JSON object: `image` (an .npz of `labels` and `spacing`, m), `conductivities` by label and `by` ("boundary
pores", "pores" or "tortuosity_fd"); prints another.
"""

import json
import sys

import numpy as np
import openpnm
from spent import Spent

TOLERANCE = 1e-10


def _network(values, h, by):
    """Conductances of two half voxels in a row, W/K; those that conduct nothing are taken out."""
    net = openpnm.network.Cubic(shape=values.shape, spacing=h)
    inside = net.Np
    if by == "boundary pores":
        net.add_boundary_pores(labels=["left", "right"], spacing=h)
    # Of the half voxel on either side: a boundary pore has none.
    half = np.zeros(net.Np)
    with np.errstate(divide="ignore"):
        half[:inside] = 0.5 / (h * values.ravel())
    net["throat.conductance"] = 1 / half[net.conns].sum(axis=1)
    openpnm.topotools.trim(net, pores=net.to_indices(np.isinf(half)))
    openpnm.topotools.trim(net, throats=net.to_indices(net["throat.conductance"] == 0))
    return net


def _by_network(values, h, by):
    """Conductivity of a body of length 1, W/(m K), and the number of pores."""
    net = _network(values, h, by)
    phase = openpnm.phase.Phase(network=net)
    phase["throat.thermal_conductance"] = net["throat.conductance"]
    heat = openpnm.algorithms.FourierConduction(network=net, phase=phase)
    ending = "_boundary" if by == "boundary pores" else ""
    heat.set_value_BC(pores=net.pores("left" + ending), values=1.0)
    heat.set_value_BC(pores=net.pores("right" + ending), values=0.0)
    heat.run(solver=openpnm.solvers.PyamgRugeStubenSolver(tol=TOLERANCE))
    length, area = net["pore.coords"][:, 0].max() - net["pore.coords"][:, 0].min(), (h * len(values)) ** 2
    return float(heat.rate(pores=net.pores("left" + ending))[0]) * length / area, net.Np


def _by_porespy(values):
    """Conductivity of a body of one conducting phase, W/(m K), and the number of its voxels."""
    from porespy.simulations import tortuosity_fd

    found = tortuosity_fd(values > 0, axis=0, tol=TOLERANCE)
    return values.max() / float(found.formation_factor), int(found.im.sum())


def main():
    """Read what is asked for, answer."""
    given = json.loads(sys.stdin.read())
    openpnm.Workspace().settings.loglevel = 50
    with np.load(given["image"]) as file:
        labels, h = file["labels"], float(file["spacing"])
    clock = Spent()
    values, by = np.array(given["conductivities"])[labels], given["by"]
    found, unknowns = _by_porespy(values) if by == "tortuosity_fd" else _by_network(values, h, by)
    answer = {"conductivity": found, "iterations": None, "unknowns": unknowns}
    print(json.dumps({**answer, "cost": clock.so_far()}))


if __name__ == "__main__":
    main()
