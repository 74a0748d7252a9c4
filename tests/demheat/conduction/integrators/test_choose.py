"""Only here: an integrator chosen that costs more than another, or whose steps are too long."""

import numpy as np
import pytest
from small_networks import system_of

from demheat.conduction.integrators import choose
from demheat.conduction.integrators.march import integrate
from demheat.conduction.integrators.spectrum import Spectrum, spectrum


def work(stats):
    """Passes over the network that a run took."""
    if stats["integrator"] == "tr-bdf2":
        return 1.5 * stats["iterations"] + 2 * stats["stages"]
    return 1.2 * stats["stages"]


@pytest.mark.parametrize("accuracy", [1e-2, 1e-4])
@pytest.mark.parametrize("name", ["rkl2", "tr-bdf2"])
def test_costs_are_about_those_of_a_run(name, accuracy):
    system = system_of("laguerre")
    times = [0.5, 1.0, 2.0]
    temperature = np.full(system.particles, 25.0)
    *_, last = integrate(system, temperature, times, integrator=name, accuracy=accuracy)
    estimate = choose.costs(spectrum(system), times[-1], accuracy, len(times))[name]
    # An estimate: within a factor of 2; found 0.9 to 1.25.
    assert 0.5 < work(last.stats) / estimate < 2.0


def test_the_cheapest_is_chosen():
    system = system_of("laguerre")
    temperature = np.full(system.particles, 25.0)
    *_, last = integrate(system, temperature, [1.0], accuracy=1e-3)
    estimates = choose.costs(spectrum(system), 1.0, 1e-3, 1)
    assert last.stats["integrator"] == min(estimates, key=estimates.get) != "euler"


def stiff(rows):
    """Spectrum of a network with a given mean row, 1/s."""
    return Spectrum(10.0 * rows, 12.0 * rows, 0.1 / rows, rows, 10)


@pytest.mark.parametrize(
    ("rows", "accuracy", "outputs", "name"),
    [
        (1.0, 1e-3, 1, "rkl2"),  # hardly stiff
        (1e4, 1e-3, 1, "tr-bdf2"),
        (1e7, 1e-3, 1, "tr-bdf2-multigrid"),  # hundreds of iterations with the diagonal alone
        (5.0, 1e-3, 100_000, "euler"),  # asked for at more times than there are stable steps
    ],
)
def test_where_each_is_best(rows, accuracy, outputs, name):
    assert choose.chosen(stiff(rows), 1.0, accuracy, outputs) == name


def test_euler_is_chosen_only_where_its_steps_are_short_enough():
    # A hundred outputs, cheapest by Euler: enough at an accuracy of 0.1, which takes 5 steps; 1e-3 takes 500.
    slow = stiff(4.0)
    assert choose.chosen(slow, 1.0, 0.1, 100) == "euler"
    assert choose.chosen(slow, 1.0, 1e-3, 100) != "euler"
    assert choose.chosen(slow, 1.0, 0.1, 100, moving=True) != "euler"
