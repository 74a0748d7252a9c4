"""Closed surfaces of triangles for tests: rings, bricks and their arrays."""

from itertools import product

import numpy as np


def ring(large=0.28, small=0.12, around=48, across=24, middle=(0.5, 0.5, 0.5), twisted=False):
    """A torus about z; twisted, its ends are joined the wrong way round, so that it has one side only."""
    u, v = (2 * np.pi * np.arange(n) / n for n in (around, across))
    u, v = (each.ravel() for each in np.meshgrid(u, v, indexing="ij"))
    out = large + small * np.cos(v)
    points = np.column_stack([out * np.cos(u), out * np.sin(u), small * np.sin(v)]) + middle
    here = np.arange(around * across).reshape(around, across)
    there = np.roll(here, -1, axis=0)
    if twisted:
        there[-1] = np.roll(there[-1][::-1], 1)
    beside, beyond = np.roll(here, -1, axis=1), np.roll(there, -1, axis=1)
    halves = np.stack([here, there, beyond], -1), np.stack([here, beyond, beside], -1)
    return points, np.concatenate([half.reshape(-1, 3) for half in halves])


def brick(sides=(0.5, 0.375, 0.75), middle=(0.5, 0.5, 0.5)):
    """A box of twelve triangles."""
    points = (np.array(list(product((0, 1), repeat=3))) - 0.5) * sides + middle
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, np.array([half for a, b, c, d in quads for half in ((a, b, c), (a, c, d))])


def ball(radius=0.3, middle=(0.5, 0.5, 0.5), halvings=3):
    """Triangles as large as each other, 8 times 4 for each halving, which hold as much as a sphere."""
    points = np.concatenate([np.eye(3), -np.eye(3)])
    faces = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    for _ in range(halvings):
        ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        edges, own = np.unique(ends, axis=0, return_inverse=True)
        between = points[edges].sum(axis=1)
        (a, b, c), (ab, bc, ca) = faces.T, (len(points) + own.reshape(-1, 3)).T
        points = np.concatenate([points, between / np.linalg.norm(between, axis=1, keepdims=True)])
        faces = np.concatenate([np.stack(each, 1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    one, two, three = points[faces].transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", one, np.cross(two, three)) / 6
    return middle + points * radius * (4 / 3 * np.pi / volume) ** (1 / 3), faces


def joined(*bodies):
    """Several surfaces as one."""
    points, triangles, count = [], [], 0
    for own, faces in bodies:
        points.append(own)
        triangles.append(faces + count)
        count += len(own)
    return np.concatenate(points), np.concatenate(triangles)
