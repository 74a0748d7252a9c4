"""Which grains exchange heat: pairs that touch or are near each other, grains at walls, and contacts out of a file."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from demheat.grains.laws import Fixed, Gap, Hertz, Overlap, contact_conductance, gap_conductance, reduced, resistivity
from demheat.network.base import SIDES, image_codes, image_shifts, row_numbers
from demheat.packing.base import Packing
from demheat.packing.neighbours import neighbours
from demheat.packing.walls import wall_distance
from demheat.scene.inputs import finite, reals

# Conductance of what holds a grain of a layer at its wall's temperature, over that of all its links. At 1e6 rounding
# kept residuals above 1e-10; conductivities take the temperatures that the grains do have.
HELD = 1e4
# Of lengths of a file.
ROUNDING = 1e-9


class Contacts(NamedTuple):
    """Pairs of grains that touch, as a simulation knows them; see `demheat.grains.read_contacts`.

    Attributes
    ----------
    first, second : (m,) int arrays
        Numbers of the grains, from 0.
    radius : (m,) float array, m, optional
        Of the contacts.
    force : (m, 3) float array, N, optional
        On the first grain, as `pressed` needs it.

    Examples
    --------
    >>> import numpy as np
    >>> from demheat import grains
    >>> millimetres = grains.Contacts(np.array([0]), np.array([1]), radius=np.array([0.2]))
    >>> print(millimetres.scaled(1e-3).radius)
    [0.0002]
    """

    first: np.ndarray
    second: np.ndarray
    radius: np.ndarray | None = None
    force: np.ndarray | None = None

    def pressed(self, packing: Packing, law: Hertz) -> Contacts:
        """The same contacts with radii by the normal part of their forces; those that are not pressed have none.

        Parameters
        ----------
        packing : Packing
        law : Hertz
            With a modulus.

        Raises
        ------
        ValueError
            If there are no forces, or all of them pull, as those on the other grain do; or the law has no modulus.
        """
        if self.force is None:
            raise ValueError("Contacts.force = None: contact radii by forces need forces, (m, 3) in newtons")
        branch, distance, _ = branches_of(packing, self.first, self.second)
        # What presses pushes the first grain away from the second.
        pressing = -np.einsum("ij,ij->i", self.force, branch) / distance
        if len(pressing) and not np.any(pressing > 0):
            raise ValueError("Contacts.force: presses no two grains together; must be that on the first of each pair")
        radii = packing.radii[self.first], packing.radii[self.second]
        return self._replace(radius=law.pressed(pressing, *radii))

    def scaled(self, factor: float) -> Contacts:
        """The same contacts with radii multiplied by a factor, which must be > 0, as `Packing.scaled`."""
        finite("factor", factor, "a finite number > 0", lambda v: v > 0)
        return self._replace(radius=None if self.radius is None else self.radius * factor)


class Pairs(NamedTuple):
    """Pairs of grains that exchange heat."""

    # first, second: (m,) int arrays: Numbers of the grains
    first: np.ndarray
    second: np.ndarray
    image: np.ndarray  # (m,) uint8 array: Which periodic image of the second one, see `demheat.network.base.Facets`
    gap: np.ndarray  # (m,) float array, m: Between the surfaces; negative where spheres overlap
    radius: np.ndarray  # (m,) float array, m: Of the contact; 0 where there is a gap
    # contact, medium: (m,) float arrays, W/K: Conductances of the contact, and of the medium beside it
    contact: np.ndarray
    medium: np.ndarray

    @property
    def conductance(self) -> np.ndarray:
        """Of contact and medium together, (m,) float array, W/K."""
        return self.contact + self.medium


class AtWalls(NamedTuple):
    """Grains that exchange heat with a wall."""

    # grain, side: (w,) int arrays: Numbers of the grain, and of the wall in `demheat.network.base.SIDES`
    grain: np.ndarray
    side: np.ndarray
    distance: np.ndarray  # (w,) float array, m: From the centre to where the wall's temperature acts
    radius: np.ndarray  # (w,) float array, m: Of the contact
    # contact, medium: (w,) float arrays, W/K: Conductances of the contact, and of the medium beside it; of a layer what
    # holds the grain
    contact: np.ndarray
    medium: np.ndarray

    @property
    def conductance(self) -> np.ndarray:
        """Of contact and medium together, (w,) float array, W/K."""
        return self.contact + self.medium


def pairs_of(packing, solid, contact, gap) -> Pairs:
    """All pairs that touch or, where there is a medium, are near each other."""
    first, second = _candidates(packing, contact, gap)
    _, distance, image = branches_of(packing, first, second)
    radii = packing.radii[first], packing.radii[second]
    _check_apart(first, second, distance, radii)
    width, least = distance - radii[0] - radii[1], np.minimum(*radii)
    radius = (
        _listed(packing, first, second, contact) if isinstance(contact, Contacts) else contact.radius(distance, *radii)
    )
    kept = radius > 0 if gap is None else (radius > 0) | (width <= gap.widest * least)
    longest = float(distance[kept].max(initial=0.0))
    _check_box(packing, longest, max(longest, (2.0 + _reach(contact, gap)) * float(packing.radii.max())))
    first, second, image, width, radius, least = (x[kept] for x in (first, second, image, width, radius, least))
    both = resistivity(solid[first], solid[second])
    medium = np.zeros(len(first))
    if gap is not None:
        around = reduced(packing.radii[first], packing.radii[second])
        medium = gap_conductance(width, radius, gap.disc * least, around, both, gap.conductivity)
    return Pairs(first, second, image, width, radius, contact_conductance(radius, both), medium)


def at_walls(packing, solid, contact, gap, sides) -> AtWalls:
    """Grains that touch some walls or are near them; of contacts out of a file, by their overlap with the wall."""
    law, found = Overlap() if isinstance(contact, Contacts) else contact, []
    for name in sides:
        distance = wall_distance(packing, name)
        radius = law.wall_radius(distance, packing.radii)
        near = radius > 0 if gap is None else (radius > 0) | (distance <= (1.0 + gap.widest) * packing.radii)
        grain = np.flatnonzero(near)
        radius, distance, own, rho = radius[grain], distance[grain], packing.radii[grain], 1.0 / solid[grain]
        medium = np.zeros(len(grain))
        if gap is not None:
            medium = gap_conductance(distance - own, radius, gap.disc * own, own, rho, gap.conductivity)
        side = np.full(len(grain), SIDES.index(name))
        found.append((grain, side, distance, radius, contact_conductance(radius, rho), medium))
    return AtWalls(*map(np.concatenate, zip(*found, strict=True)))


def in_layers(packing, pairs, depth, sides) -> AtWalls:
    """Grains whose centres lie within a depth of some walls, held at the temperature of the wall."""
    both = np.concatenate((pairs.first, pairs.second))
    links = np.bincount(both, np.tile(pairs.conductance, 2), minlength=packing.number)
    found = []
    for name in sides:
        grain = np.flatnonzero(wall_distance(packing, name) <= depth)
        found.append((grain, np.full(len(grain), SIDES.index(name)), HELD * links[grain]))
    grain, side, conductance = map(np.concatenate, zip(*found, strict=True))
    if len(np.unique(grain)) < len(grain):
        raise ValueError(f"layer = {depth!r}: layers of two walls share grains; must be thinner")
    # At the centres, and through no contact of a radius.
    none = np.zeros(len(grain))
    return AtWalls(grain, side, none, none, conductance, none)


def branches_of(packing, first, second):
    """Way from the first to the nearest image of the second grain of each pair."""
    straight = packing.centers[second] - packing.centers[first]
    shift = np.where(packing.periodic, -np.round(straight / packing.size), 0.0)
    image = image_codes(shift)
    branch = straight + image_shifts(image, packing.size)
    return branch, np.sqrt(np.einsum("ij,ij->i", branch, branch)), image


def _candidates(packing, contact, gap):
    """Pairs near enough to look at, each once, rising; and those of a list of contacts."""
    indptr, indices = neighbours(packing, skin=_reach(contact, gap) * float(packing.radii.max()))
    rows, others = row_numbers(indptr), indices.astype(np.int64)
    once = others > rows
    keys = rows[once] * packing.number + others[once]
    if isinstance(contact, Contacts):
        keys = np.union1d(keys, _keys(packing, contact))
    return np.divmod(keys, packing.number)


def _reach(contact, gap):
    """Widest gap of a pair, over the radius of its smaller grain."""
    return max(gap.widest if gap else 0.0, contact.within if isinstance(contact, Fixed) else 0.0)


def _keys(packing, contacts):
    """One number for each listed pair, whichever of its grains comes first."""
    low, high = np.minimum(contacts.first, contacts.second), np.maximum(contacts.first, contacts.second)
    return low * packing.number + high


def _listed(packing, first, second, contacts):
    """Contact radii of pairs by a list; 0 of those that it has not."""
    keys = _keys(packing, contacts)
    order = np.argsort(keys, kind="stable")
    radius, wanted = np.zeros(len(first)), first * packing.number + second
    radius[np.searchsorted(wanted, keys[order])] = contacts.radius[order]
    return radius


def _check_apart(first, second, distance, radii):
    inside = distance <= np.abs(radii[0] - radii[1])
    if inside.any():
        k = int(np.argmax(inside))
        raise ValueError(
            f"packing: grains {first[k]} and {second[k]} are {distance[k]:.4g} m apart, with radii {radii[0][k]:.4g} "
            f"and {radii[1][k]:.4g} m: must not lie in each other"
        )


def _check_box(packing, longest, reach):
    """Refuse a period within which a pair longer than none here might meet again, by another image."""
    small = packing.periodic & (packing.size <= (longest + reach) * (1.0 + ROUNDING))
    if small.any():
        axis = int(np.argmax(small))
        raise NotImplementedError(
            f"packing.size[{axis}] = {packing.size[axis]:.4g} m, periodic: pairs reach {longest:.4g} m and may meet "
            f"again within {longest + reach:.4g} m, where the nearest image alone is known; must be longer"
        )


def checked_contacts(packing, contacts) -> Contacts:
    """A list of contacts as arrays, or a ValueError."""
    pair = [np.asarray(each) for each in contacts[:2]]
    for name, each in zip(("first", "second"), pair, strict=True):
        if each.dtype.kind not in "iu" or each.ndim != 1 or len(each) != len(pair[0]):
            raise ValueError(f"Contacts.{name}: must be (m,) whole numbers, both alike")
        if len(each) and not 0 <= each.min() <= each.max() < packing.number:
            wrong = each[(each < 0) | (each >= packing.number)][0]
            raise ValueError(f"Contacts.{name} = {wrong}: must be the number of a grain, 0 to {packing.number - 1}")
    if contacts.radius is None:
        raise ValueError("Contacts.radius = None: must be contact radii; `pressed` makes them of forces")
    radius = reals("Contacts.radius", contacts.radius, f"{len(pair[0])} numbers >= 0 m")
    if radius.shape != pair[0].shape or not np.all(np.isfinite(radius) & (radius >= 0)):
        raise ValueError(f"Contacts.radius of shape {radius.shape}: must be {len(pair[0])} finite numbers >= 0 m")
    found = Contacts(*(each.astype(np.int64) for each in pair), radius)
    if np.any(found.first == found.second) or len(np.unique(_keys(packing, found))) < len(radius):
        raise ValueError("Contacts: a grain touches itself, or a pair is there twice; must be each pair once")
    return found


LAWS = (Overlap, Hertz, Fixed)


def check_laws(contact, gap) -> None:
    """Raise ValueError unless these are laws of contact and gap."""
    if not isinstance(contact, (*LAWS, Contacts)):
        raise ValueError(f"contact = {contact!r}: must be Overlap(), Hertz(), Fixed(ratio=...) or a Contacts")
    if gap is not None and not isinstance(gap, Gap):
        raise ValueError(f"gap = {gap!r}: must be a Gap(conductivity=...), or None in a vacuum")
