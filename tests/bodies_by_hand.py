"""Bodies of nodes that edges join across periodic images, found one node after the other: the twin of the kernels."""

import numpy as np


def walk(solid, edges, jump):
    """Label of each node (-1 outside all) and whether each body climbs, by the ways through it."""
    near = {}
    for a, b, step in edges:
        near.setdefault(a, []).append((b, step))
    label, place, climbs = np.full(len(solid), -1), {}, []
    for first in np.flatnonzero(solid):
        if label[first] >= 0:
            continue
        label[first], place[first], waiting = len(climbs), np.zeros(3, int), [first]
        climbs.append(False)
        while waiting:
            a = waiting.pop()
            for b, step in near.get(a, []):
                if not solid[b]:
                    continue
                if label[b] < 0:
                    label[b], place[b] = label[a], place[a] + step
                    waiting.append(b)
                climbs[-1] |= abs((place[a] + step - place[b]) @ jump) > 1e-9
    return label, np.array(climbs)
