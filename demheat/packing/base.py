"""Packing: spheres in a box, as plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from demheat.powers import cubed
from demheat.scene.bodies import ROUND_AXES, check_name, domain_volume, from_middle, round_radius
from demheat.scene.inputs import LEAST, MOST, finite, moderate, reals
from demheat.scene.shapes.morton import morton_order

# As of scenes: volumes beyond are zero or infinite.
MODERATE = f"from {LEAST:g} to {MOST:g} m"


class Packing(NamedTuple):
    """Spheres in a domain inscribed in the box [0, size], stored so that neighbours in space are near in memory.

    `make_packing` checks what it is given; of one made or changed by hand, whatever takes it asks
    `demheat.packing.gate.check_packing`.
    """

    centers: np.ndarray  # (n, 3) float array, m: Inside the box; on a periodic axis 0 <= x < size
    radii: np.ndarray  # (n,) float array, m
    size: np.ndarray  # (3,) float array, m
    periodic: np.ndarray  # (3,) bool array: Axis by axis: True for a periodic axis, False for a hard wall at both ends
    # How it was made (algorithm, seed, number, phi, ...) and what was reached (iterations, mean_overlap, ...)
    provenance: dict
    # {"box", "cylinder-x", "cylinder-y", "cylinder-z", "sphere"}: Shape of the domain; a cylinder is named by its axis.
    # Axes across which it is round are not periodic
    domain: str = "box"

    @property
    def number(self) -> int:
        """Number of particles."""
        return len(self.radii)

    @property
    def volume(self) -> float:
        """Volume of the domain, m^3."""
        return domain_volume(self.domain, self.size)

    @property
    def phi(self) -> float:
        """Sum of the sphere volumes over the volume of the domain (overlaps counted twice)."""
        return float(4.0 / 3.0 * np.pi * np.sum(cubed(self.radii)) / self.volume)

    def scaled(self, factor: float) -> Packing:
        """The same packing with every length multiplied by `factor`, which must be > 0."""
        finite("factor", factor, "a finite number > 0", lambda v: v > 0)
        return self._replace(centers=self.centers * factor, radii=self.radii * factor, size=self.size * factor)


def make_packing(centers, radii, size, periodic, provenance: dict, *, domain: str = "box") -> Packing:
    """Check, cast and sort the arrays of a packing."""
    return sorted_packing(centers, radii, size, periodic, provenance, domain=domain)[0]


def sorted_packing(centers, radii, size, periodic, provenance: dict, *, domain: str = "box"):
    """The same and the order of its particles among those given, (n,) int array."""
    size, periodic = check_box(size, periodic)
    check_domain(domain, size, periodic)
    centers = np.array(reals("centers", centers, "(n, 3) finite numbers, n > 0"))
    radii = np.array(reals("radii", radii, "finite numbers > 0, one for each centre"))
    if not isinstance(provenance, Mapping):
        raise ValueError(f"provenance = {provenance!r}: must be a dict")
    if centers.ndim != 2 or centers.shape[1] != 3 or len(centers) == 0 or not np.all(np.isfinite(centers)):
        raise ValueError(f"centers of shape {centers.shape}: must be (n, 3) finite numbers, n > 0")
    if radii.shape != (len(centers),) or not (radii.min() >= LEAST and radii.max() <= MOST):
        raise ValueError(f"radii of shape {radii.shape}: must be {len(centers)} finite numbers > 0, {MODERATE}")
    outside = ~periodic & ((centers < 0) | (centers > size))
    if outside.any():
        which = int(np.flatnonzero(outside.any(axis=1))[0])
        raise ValueError(
            f"centers[{which}] = {centers[which].tolist()}: lies outside the walls of the box, 0 to {size}"
        )
    far = from_middle(centers, domain, size) > round_radius(domain, size)
    if far.any():
        which = int(np.argmax(far))
        raise ValueError(f"centers[{which}] = {centers[which].tolist()}: lies outside the domain {domain!r}")
    centers = wrap(centers, size, periodic)
    order = morton_order(centers, size)
    return Packing(centers[order], radii[order], size, periodic, dict(provenance), domain), order


def check_box(size, periodic):
    """Cast the sides and the periodicity of a box to arrays."""
    valid = f"three finite lengths > 0, {MODERATE}"
    sides = np.array(reals("size", size, valid))
    odd = sides.shape != (3,) or not np.all(np.isfinite(sides)) or np.any(sides <= 0) or not all(map(moderate, sides))
    if odd or any(isinstance(side, bool | np.bool_) for side in size):
        raise ValueError(f"size = {size!r}: must be {valid}")
    flags = np.asarray(periodic)
    if flags.dtype != bool or flags.shape not in ((), (3,)):
        raise ValueError(f"periodic = {periodic!r}: must be a bool or three bools, one per axis")
    return sides, np.broadcast_to(flags, 3).copy()


def check_domain(domain, size, periodic):
    """Raise ValueError unless the domain is known, and its box square and without periods across the round axes."""
    check_name("domain", domain)
    axes = list(ROUND_AXES[domain])
    if axes and (np.ptp(size[axes]) > 0 or np.any(periodic[axes])):
        raise ValueError(
            f"domain = {domain!r} with size {size.tolist()} and periodic {periodic.tolist()}: sides across its round "
            f"axes {axes} must be equal and not periodic"
        )


def wrap(centers, size, periodic):
    """Centres moved into 0 <= x < size on the periodic axes, (n, 3) float array, m."""
    wrapped = centers - np.where(periodic, np.floor(centers / size) * size, 0.0)
    # A tiny negative x wraps to exactly `size` by rounding: that is 0.
    return np.where(periodic & (wrapped >= size), 0.0, wrapped)
