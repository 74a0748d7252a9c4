"""Milton's third-order parameter of dispersions, from one translation of unit dipoles."""

import math

import numpy as np

from demheat.runtime.process_state import one_blas_thread
from demheat.scene import Scene, check_scene
from references.multipole.arrangement import arrange, smallest_gap
from references.multipole.fast import FastMultipole, plan
from references.multipole.sums import entries
from references.multipole.translations import received, translation

# What the table of translations may cost, in bytes.
MOST_BYTES = 3e9
# More spheres than this exchange by cells, up to that order, with that relative error of what dipoles make.
MANY, HIGHEST_BY_CELLS, PRECISION = 100, 40, 1e-12
# At 150 square roots of factorials overflow; small spheres add powers.
HIGHEST_ORDER = 80
# Neglected share of what a dipole makes at its nearest neighbour, without the powers of the degree that come with it.
ENOUGH = 1e-15


def zeta2(scene: Scene, *, order: int | None = None) -> float:
    """Milton's parameter zeta_2 of the spheres of a periodic cell, averaged over the three axes.

    With p = -alpha a^3 g the dipoles and T the translation, the conductivity at third order in beta = (s - 1)/(s + 2)
    is c_3 = (4 pi/V) sum over spheres and lm of 3l/(2l+1) abs(C_lm)^2, C = T a^3 what unit dipoles make at each other;
    by Torquato's expansion (Random Heterogeneous Materials, 2002, sec. 20.1) the mean of c_3 over the axes is
    3 phi_2^3 + 6 phi_1 phi_2 zeta_2. The mean of the first two orders over the axes is that of an isotropic medium.

    Parameters
    ----------
    scene : Scene
        Periodic, all spheres of one material; its conductivities do not matter.
    order : int, optional
        Highest degree received. By default one that leaves a relative error of some 1e-12, or else an error is raised;
        one that is given leaves some (a/d)^(2 order), a the largest radius and d its least distance to a centre.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If there is no sphere or not all spheres are of one material, or the order is too high for memory or precision.
    NotImplementedError
        For walls, layers, nested spheres, surfaces with a resistance.
    RuntimeError
        If the order that the gaps and radii ask for is too high.

    Examples
    --------
    >>> from demheat import gallery
    >>> from references import multipole
    >>> print(f"{multipole.zeta2(gallery.sphere_in_cube(5.0, periodic=True)):.8f}")
    0.00200341
    """
    check_scene(scene)
    if not scene.periodic:
        raise NotImplementedError("multipole: walls; zeta_2 is that of a periodic cell")
    scene.require("zeta_2 is of two phases, without interfaces of their own")
    spheres, _, _, unit = arrange(scene, any_matrix=True)
    if len(set(spheres.contrasts.tolist())) != 1:
        raise ValueError(
            f"Scene.inclusions: {len(spheres.radii)} spheres of {len(set(spheres.contrasts.tolist()))} materials; "
            "zeta_2 is defined for one or more spheres of one material"
        )
    order = _order(spheres, unit, order)
    # See `solver.solve`.
    with one_blas_thread():
        return _zeta2(spheres, order)


def _zeta2(spheres, order):
    table = _exchange(spheres, order)
    n, m = entries(order)
    weight = np.where(n > 0, 3 * n / (2 * n + 1), 0.0) * np.where(m > 0, 2.0, 1.0) * spheres.radii[:, None]
    volume, total = float(np.prod(spheres.size)), 0.0
    for component, entry, size in ((0, 1, 1.0), (0, 2, math.sqrt(0.5)), (1, 2, math.sqrt(0.5))):
        dipoles = np.zeros((2, len(spheres.radii), len(n)))
        # Moment a^3 in units of a^2, along z, x, y.
        dipoles[component, :, entry] = size * spheres.radii
        total += 4 * math.pi / volume * np.sum(weight * received(spheres, table, dipoles) ** 2) / 3
    phi = 4 / 3 * math.pi * np.sum(spheres.radii**3) / volume
    return float((total - 3 * phi**3) / (6 * phi * (1 - phi)))


def _exchange(spheres, order):
    if len(spheres.radii) > MANY:
        return FastMultipole(spheres, plan(spheres, order, PRECISION))
    return translation(spheres, order + 1)


def check_order(order) -> None:
    """Raise ValueError unless an order is an integer of 1 or more."""
    if not isinstance(order, int | np.integer) or isinstance(order, bool) or order < 1:
        raise ValueError(f"order = {order!r}: must be an integer >= 1")


def _order(spheres, unit, order):
    """The order that was given, or the one that is enough; refused beyond what memory and numbers hold."""
    count = len(spheres.radii)
    # Entries of degree order + 1 for each pair.
    memory = math.sqrt(2 * MOST_BYTES / (16 * (1 + count * (count - 1) / 2))) - 3
    highest = HIGHEST_BY_CELLS if count > MANY else min(HIGHEST_ORDER, int(memory))
    if order is not None:
        check_order(order)
        if order > highest:
            raise ValueError(f"order = {order}: must be <= {highest} for {count} spheres in memory and precision")
        return order
    gap = max(smallest_gap(spheres), 0.0)
    ratio = spheres.radii.max() / (spheres.radii.max() + spheres.radii.min() + gap)
    needed = max(4, math.ceil(math.log(ENOUGH) / (2 * math.log(ratio))))
    if needed > highest:
        small, large = (unit * radius for radius in (spheres.radii.min(), spheres.radii.max()))
        raise RuntimeError(
            f"multipole: smallest gap {gap * unit:.3g} m between {count} spheres of radii {small:.3g} to {large:.3g} m "
            f"needs order {needed}; {highest} is the highest in memory and precision. Give order=... to accept less"
        )
    return needed
