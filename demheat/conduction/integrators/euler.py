"""Explicit Euler steps, the papers' own (Haddad et al. 2021, eq. 6)."""

import numpy as np

from demheat.conduction.integrators import transient_kernels as kernels
from demheat.conduction.integrators.step import Step

ORDER = 1
ESTIMATES = False


def stepper(system, spectrum):
    """Explicit Euler on a system."""

    def advance(x, time, step, memory, estimate):
        heat, totals = system.heat(x, time)
        new = np.empty_like(x) if memory is None else memory
        kernels.forward(system.links, system.inverse, heat, step, x, new)
        inflow = step * system.inflow(x, totals)
        system.hold(new, time + step)
        # Two arrays take turns: the old state is free once this one is accepted.
        return Step(new, inflow, None, 1, memory=x)

    return advance


def largest_step(spectrum):
    """Largest stable step, s."""
    return spectrum.limit
