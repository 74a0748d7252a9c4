"""First cells of each fraction, which all methods and the paper's network have."""

from studies.common import silica_epoxy

FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
# Fraction at which the boundary conditions are compared.
WALLED = 0.4


def first_cells(held):
    """First cells by their fraction, as text: periodic ones, or those between isothermal walls."""
    kind, boundary, some = ("walled", "walls", (WALLED,))
    if held == "periodic":
        kind, boundary, some = ("periodic", "gradient", FRACTIONS)
    return {f"{fraction:g}": silica_epoxy.scene(kind, fraction, seed=0, boundary=boundary) for fraction in some}
