"""What a solve on many cores would take: work over measured bandwidth, messages and sums over an assumed network.

Each core is a rank with a block of the body. Stages and what they grow with, each with one constant that rows give:
twins with the twins of the whole body, which every rank makes; packing and cells with the particles that a rank sees,
its block and a layer around it; set-up and field with its unknowns; iterations with the bytes that they move. Messages
and sums of an iteration are those that PETSc counted on two ranks. No network was measured: see `NETWORK`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from demheat.mpi.slabs import GHOSTS, PHI

# In mean spacings: what a block sees of its neighbours.
LAYER = GHOSTS * (0.75 / math.pi * PHI) ** (1 / 3)
# Links of a particle, of the rows of part "elements".
LINKS = 14.5
# Bytes that an iteration moves for an unknown at least: the product (number and conductance of each link, diagonal and
# three vectors), two sweeps and what they leave (number, place and single value of each link, eight single vectors),
# vectors of conjugate gradients (ten of eight bytes), and the levels below (six times an eighth of twenty entries).
MOVED = (12 * LINKS + 40) + (2 * 9 * LINKS + 32) + 80 + 6 * 12 * 20 / 8
# Fewer unknowns are not fitted: what does not grow weighs.
FROM = 400_000
# What is asked: cores and unknowns. And unknowns that this PETSc cannot number, nor a slab be thick enough for.
CORES, SIZES, COUNTED = (64, 1024, 16_384), (1e9, 1e10), 2**31
STAGES = ("packing", "cells", "setup", "iterate", "field")


class Network(NamedTuple):
    """What joins cores of different machines."""

    latency: float  # s, of a message, and of one step of a sum over all
    node_gbs: float  # GB/s that leave a node
    cores: int  # of a node


# Assumed, none of it measured here. Half a round trip of Open MPI between two servers took 1.93 microseconds ("MPI over
# 40Gb Ethernet", blogs.cisco.com); 25 GB/s are the 200 Gb/s of a port of the Slingshot network (De Sensi et al., SC20,
# arXiv:2008.08886), as if all of them were had. Cores of a node: assumed without a source.
NETWORK = Network(2e-6, 25.0, 64)


class Fit(NamedTuple):
    """Constants of the rows."""

    twins: float  # s for each twin of the body
    packing: float  # s for each particle seen
    cells: float  # s for each particle seen
    setup: float  # s for each unknown
    share: float  # of the triad's bandwidth that iterations have
    field: float  # s for each unknown
    triad: float  # bytes/s of a rank, all others at work
    iterations: float  # at 1e6 unknowns
    growth: float  # iterations more for ten times the unknowns
    messages: float  # of an iteration, to each neighbour
    rim: float  # bytes of an iteration for each squared spacing of a cut
    sums: float  # of an iteration
    crowd: float  # twins over unknowns^(2/3)
    held: float  # bytes for each particle seen
    base: float  # bytes of a rank, Python and libraries


class Blocks(NamedTuple):
    """A body cut into blocks along its axes, in mean spacings."""

    lengths: tuple[float, float, float]
    counts: tuple[int, int, int]

    @property
    def edges(self):
        """Of a block."""
        return np.array(self.lengths) / self.counts

    @property
    def inner(self):
        """Faces of a block towards others along each axis, on average."""
        return 2.0 * (1.0 - 1.0 / np.array(self.counts))

    @property
    def own(self):
        """Particles of a block."""
        return float(np.prod(self.edges))

    @property
    def seen(self):
        """Particles of a block and of the layer around it."""
        return float(np.prod(self.edges + self.inner * LAYER))

    @property
    def cut(self):
        """Surface of a block towards others, squared spacings."""
        return float(np.sum(self.inner * self.own / self.edges))

    @property
    def neighbours(self):
        """Of a block in the midst, corners included."""
        return math.prod(min(count, 3) for count in self.counts) - 1


def slabs(unknowns, ranks, number=1):
    """A row of cubes cut across."""
    edge = (unknowns / number) ** (1 / 3)
    return Blocks((number * edge, edge, edge), (ranks, 1, 1))


def bricks(unknowns, ranks):
    """A cube cut along all axes, into blocks that are as near to cubes as can be."""
    counts = [(a, b, ranks // (a * b)) for a in _divisors(ranks) for b in _divisors(ranks // a)]
    edge = unknowns ** (1 / 3)
    # The surface of a block of a cube goes with the sum of their numbers.
    return Blocks((edge,) * 3, min(counts, key=sum))


def _divisors(number):
    return [each for each in range(1, number + 1) if number % each == 0]


def most_slabs(unknowns):
    """So many slabs of a cube are as thick as what they see of each other, and no more."""
    return int(unknowns ** (1 / 3) / LAYER)


def fitted(rows):
    """Constants of rows, each by least squares of what is relative."""
    from scipy.optimize import nnls

    blocks = [_blocks(row) for _, row in rows.iterrows()]
    seen, own = (np.array([getattr(each, name) for each in blocks]) for name in ("seen", "own"))
    time = {stage: _seconds(rows, stage).to_numpy(float) for stage in STAGES}
    (twins, packing), _ = nnls(np.stack([rows["twins"], seen], axis=1) / time["packing"][:, None], np.ones(len(rows)))
    triad, rounds = 1e9 * rows["triad_rank_gbs"].to_numpy(float), rows["iterations"].to_numpy(float)
    decades = np.log10(rows["unknowns"].to_numpy(float) / 1e6)
    growth, middle = np.polyfit(decades, rounds, 1)
    growth = max(growth, 0.0)
    many = (rows["ranks"] > 1).to_numpy()
    cut, beside = (np.array([getattr(each, name) for each in blocks])[many] for name in ("cut", "neighbours"))
    return Fit(
        twins=twins,
        packing=packing,
        cells=_constant(seen, time["cells"]),
        setup=_constant(own, time["setup"]),
        share=1.0 / _constant(rounds * MOVED * own / triad, time["iterate"]),
        field=_constant(own, time["field"]),
        triad=float(triad.min()),
        iterations=middle if growth else float(rounds.mean()),
        growth=growth,
        messages=float(np.mean((rows["messages"] / rows["iterations"])[many] / beside)),
        rim=float(np.mean((rows["message_bytes"] / rows["iterations"])[many] / cut)),
        sums=float(np.mean((rows["reductions"] / rows["iterations"])[many])),
        crowd=float(np.mean(rows["twins"] / (rows["number"] ** (1 / 3) * rows["unknowns"] ** (2 / 3)))),
        held=_constant(seen, rows["peak_mib"].to_numpy(float) * 2**20 / rows["ranks"].to_numpy(float)),
        base=float(np.mean(rows["base_mib"] * 2**20 / rows["ranks"])),
    )


def _constant(what, times):
    """The factor of the least relative squares."""
    ratio = np.asarray(what) / times
    return float(ratio.sum() / (ratio**2).sum())


def _blocks(row):
    return slabs(row["unknowns"], int(row["ranks"]), int(row["number"]))


def _seconds(rows, stage):
    """Of the slowest rank; what the solve takes before its iterations is set-up."""
    if stage == "setup":
        return rows["solve_wall_s"] - rows["iterate_wall_s"]
    return rows[f"{stage}_wall_s"]


def of_row(fit, row):
    """What the model says of a row, its ranks on one machine: seconds of each stage and their sum."""
    here = fit._replace(triad=1e9 * row["triad_rank_gbs"])
    return _stages(here, _blocks(row), row["unknowns"], row["twins"], None)


def predicted(fit, unknowns, blocks, network=NETWORK):
    """What a cube with one sphere would take, a core for each block."""
    twins = fit.crowd * unknowns ** (2 / 3)
    found = _stages(fit, blocks, unknowns, twins, network)
    return found | {"twins": fit.twins * twins, "gib": (fit.held * blocks.seen + fit.base) / 2**30}


def _stages(fit, blocks, unknowns, twins, network):
    rounds = fit.iterations + fit.growth * math.log10(unknowns / 1e6)
    ranks, messages, sums = math.prod(blocks.counts), 0.0, 0.0
    if network:
        each = 1e9 * network.node_gbs / network.cores
        messages = rounds * (fit.messages * blocks.neighbours * network.latency + fit.rim * blocks.cut / each)
        sums = rounds * fit.sums * math.ceil(math.log2(ranks)) * network.latency
    work = rounds * MOVED * blocks.own / (fit.share * fit.triad)
    found = {
        "packing": fit.twins * twins + fit.packing * blocks.seen,
        "cells": fit.cells * blocks.seen,
        "setup": fit.setup * blocks.own,
        "iterate": work + messages + sums,
        "field": fit.field * blocks.own,
    }
    return found | {"all": sum(found.values()), "messages": messages, "sums": sums, "iterations": rounds}


def rows_of(df):
    """Rows that the model is fitted to."""
    if "ranks" not in df:
        return df[:0]
    return df[df["part"].isin(("strong", "weak")) & (df["status"] == "ok") & (df["unknowns"] >= FROM)]


def left_out(rows):
    """Relative error of all seconds of each row, %, by the model that is fitted to the others."""
    found = []
    for k in range(len(rows)):
        others, row = rows.drop(rows.index[k]), rows.iloc[k]
        if len(others) >= 3 and (others["ranks"] > 1).any():
            found.append(100.0 * (of_row(fitted(others), row)["all"] / row["wall_s"] - 1.0))
    return found


def plans(rows):
    """What sizes and cores of interest would take, cut into slabs where they are thick enough, and into bricks."""
    if len(rows) < 3 or not (rows["ranks"] > 1).any():
        return []
    fit, found = fitted(rows), []
    for unknowns in SIZES:
        for cores in CORES:
            for shape, cut in (("slabs", slabs), ("bricks", bricks)):
                if shape == "slabs" and cores > most_slabs(unknowns):
                    continue
                what = {"unknowns": unknowns, "cores": cores, "shape": shape}
                found.append(what | predicted(fit, unknowns, cut(unknowns, cores)))
    return found
