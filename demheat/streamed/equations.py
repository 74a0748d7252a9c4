"""The heat balance of all slabs as one network, mapped from disk: as much of it as a steady solve reads."""

from __future__ import annotations

import numpy as np

from demheat.network.base import Network
from demheat.packing.base import wrap
from demheat.streamed.store import Parts
from demheat.tiles.places import NOBODY, found_at

# What one step of a periodic image adds to its code, by axis.
STEPS = (9, 3, 1)
LINKS = {"indices": np.uint32, "image": np.uint8, "conductance": float}
WALLS = ("wall_side", "wall_conductance", "wall_area", "wall_distance", "wall_normal")


def number_all(parts: Parts) -> None:
    """Number the particles that each slab sees: its own in one run, others as their owners do, and at which image."""
    store, size, periodic = parts.store, np.array(parts.scene.size), np.broadcast_to(parts.scene.periodic, 3)
    for slabs, own, first in zip(parts.cuts, parts.own, parts.first, strict=False):
        here, axis = slabs.rank, slabs.axis
        beside = store.get(here, "centers")[own:]
        inside = wrap(beside, size, periodic)
        numbers, turns = np.full(own + len(beside), NOBODY), np.zeros(own + len(beside), np.int8)
        numbers[:own], owner = first + np.arange(own), slabs.owner(inside)
        for other in np.unique(owner):
            rows, theirs = np.flatnonzero(owner == other), store.get(other, "centers")[: parts.own[other]]
            found = found_at(inside[rows], theirs, slabs)
            rows, found = rows[found != NOBODY], found[found != NOBODY]
            numbers[own + rows] = parts.first[other] + found
            turns[own + rows] = np.rint((beside[rows, axis] - theirs[found, axis]) / slabs.length)
        links = store.get(here, "indices")[: store.get(here, "indptr")[own]]
        if np.any(numbers[links] == NOBODY):
            raise RuntimeError("demheat.streamed: a particle beside a slab's own is unknown to its owner")
        store.put(here, "numbers", numbers)
        store.put(here, "turns", turns)


def joined(parts: Parts) -> Network:
    """One network of all slabs' own rows: links, images and centres mapped from disk."""
    store, first = parts.store, parts.first
    ends = [int(store.get(slabs.rank, "indptr")[own]) for slabs, own in zip(parts.cuts, parts.own, strict=True)]
    begin = np.concatenate([[0], np.cumsum(ends)])
    columns = {name: store.mapped(name, (int(begin[-1]),), kind) for name, kind in LINKS.items()}
    centers, indptr = store.mapped("centers", (int(first[-1]), 3), float), np.empty(first[-1] + 1, np.int64)
    indptr[-1] = begin[-1]
    kept = {name: [] for name in ("volumes", "wall_particle", *WALLS)}
    for slabs, own in zip(parts.cuts, parts.own, strict=True):
        here = slabs.rank
        rows, to = slice(first[here], first[here + 1]), slice(begin[here], begin[here + 1])
        centers[rows], indptr[rows] = store.get(here, "centers")[:own], begin[here] + store.get(here, "indptr")[:own]
        kept["volumes"].append(store.get(here, "volumes")[:own])
        _put_links(store, slabs, {name: column[to] for name, column in columns.items()})
        walls = store.get(here, "wall_particle") < own
        kept["wall_particle"].append(first[here] + store.get(here, "wall_particle")[walls])
        for name in WALLS:
            kept[name].append(store.get(here, name)[walls])
    whole = {name: np.concatenate(values) for name, values in kept.items()}
    body = {"size": np.array(parts.scene.size), "periodic": np.full(3, parts.scene.periodic), "phase": None}
    return Network(centers=centers, indptr=indptr, **columns, **whole, **body)


def _put_links(store, slabs, to):
    """The links of a slab's own rows, by the numbers of all and by images of the whole body."""
    here, end = slabs.rank, len(to["indices"])
    indices = store.get(here, "indices")[:end]
    to["conductance"][:] = store.get(here, "conductance")[:end]
    to["indices"][:] = store.get(here, "numbers")[indices]
    to["image"][:] = store.get(here, "image")[:end] + STEPS[slabs.axis] * store.get(here, "turns")[indices]
