"""A program of others on a scene of the frontier, in a process of its own (`studies.peers`)."""

from dataclasses import replace

from studies.common.searches.ways import Way, knobs_at
from studies.harness import runner


def found(way: Way, scene, value):
    """What it finds at a value of its knob, and at what cost; a cube conducts alike along all axes here."""
    home = runner.load("peers").program(way.method)
    if why := home.missing():
        raise NotImplementedError(why)
    # Its scripts have the load along x.
    cold, warm = sorted(scene.wall_temperatures.values())
    return home.solve(replace(scene, walls={"x-": warm, "x+": cold}), **knobs_at(way, value, scene))
