"""Steady temperatures where conductivities depend on them: conductances at the last round's, until these meet theirs.

On its way through a facet heat sees either side's mean conductivity between the particle's temperature and the facet's:
d q / S = integral of k from one to the other (Kirchhoff), exact where heat runs along the link. A homogeneous network
is then linear in that integral, whatever the temperatures. Picard's iteration takes off a part ln(k_max / k_min) /
(2 pi) of the error of a homogeneous body in each round.
"""

import numpy as np

from demheat.conduction.balance import level_of
from demheat.conduction.steady import imbalance, solve_checked
from demheat.network.base import branches, link_distances, row_numbers

# Rounds at most, and what each round's linear equations leave of the residual that it begins with.
ROUNDS, FURTHER = 60, 1e-2
# Of a link's resistance: less beside that of its two sides is rounding, more is a surface that resists.
ROUNDING = 1e-9


class Conductances:
    """Those of a network at given temperatures."""

    def __init__(self, network, scene):
        self.network, self.depends = network, scene.dependences
        self.open = np.flatnonzero(network.conductance > 0)
        row, other = row_numbers(network.indptr)[self.open], network.indices[self.open].astype(np.int64)
        # Each link stands in both of its rows: once is enough.
        pair = np.minimum(row, other) * len(network.centers) + np.maximum(row, other)
        _, once, self.pair = np.unique(pair, return_index=True, return_inverse=True)
        self.row, self.other, link = row[once], other[once], self.open[once]
        k, area = scene.conductivities[network.phase], network.area[link]
        links = network.indptr, network.indices, network.image
        step = branches(network.centers, network.size, *links)[link]
        length = np.sqrt(np.einsum("ij,ij->i", step, step))
        share = np.clip(link_distances(network)[link] / length, 0.0, 1.0)
        self.here, self.there = share * length / (k[self.row] * area), (1 - share) * length / (k[self.other] * area)
        # What else the network has in series: surfaces that resist.
        whole = 1.0 / network.conductance[link]
        surface = whole - self.here - self.there
        self.surface = np.where(surface > ROUNDING * whole, surface, 0.0)
        self.factors = np.ones(len(link)), np.ones(len(link))

    def at(self, temperature, walls):
        """The network at temperatures."""
        network, phase = self.network, self.network.phase
        self._meet(temperature)
        conductance = np.zeros(len(network.conductance))
        conductance[self.open] = (1.0 / self._resistance())[self.pair]
        particle = network.wall_particle
        factor = self.depends.mean(phase[particle], temperature[particle], walls)
        return network._replace(conductance=conductance, wall_conductance=factor * network.wall_conductance)

    def _resistance(self):
        here, there = self.factors
        return self.here / here + self.there / there + self.surface

    def _meet(self, temperature):
        """Factors of either side, between its particle and the facet: the latter's temperature by those before."""
        phase, one, other = self.network.phase, temperature[self.row], temperature[self.other]
        heat = (other - one) / self._resistance()
        near, far = one + heat * self.here / self.factors[0], other - heat * self.there / self.factors[1]
        self.factors = (
            self.depends.mean(phase[self.row], one, near),
            self.depends.mean(phase[self.other], other, far),
        )


def solve_varying(network, scene, *, solver, tolerance, max_iterations):
    """Temperatures at which every particle receives as much heat as it gives, with conductivities at these."""
    conducting, start, total, aim, level = Conductances(network, scene), None, 0, FURTHER, level_of(scene)
    for rounds in range(1, ROUNDS + 1):
        solution = solve_checked(
            network, scene, solver=solver, tolerance=aim, max_iterations=max_iterations, start=start
        )
        start, total = np.nan_to_num(solution.temperature, nan=level), total + solution.stats["iterations"]
        renewed = conducting.at(start, np.nan_to_num(solution.wall_temperature, nan=level))
        left = imbalance(renewed, scene, solution)
        if left <= tolerance:
            said = {"iterations": total, "rounds": rounds, "residual": left}
            return network, solution._replace(stats=solution.stats | said)
        network, aim = renewed, min(FURTHER, max(FURTHER * left, 0.5 * tolerance))
    raise RuntimeError(
        f"solve_varying: relative residual {left:.2e} after {ROUNDS} rounds, each with conductivities at the last "
        f"one's temperatures, asked for {tolerance:.1e}; must be a smaller change of conductivity, or larger"
    )
