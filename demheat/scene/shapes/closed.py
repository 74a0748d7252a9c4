"""Whether triangles are a closed surface: corners joined, no edge open, none crossing, all looking outwards."""

import numpy as np

from demheat.scene.shapes.triangles import PAIRS, THIN, Triangles

EDGES = ((0, 1), (1, 2), (2, 0))


def closed(name: str, vertices, triangles) -> Triangles:
    """A closed surface of triangles that look outwards, or a ValueError.

    Corners at the same place are one; which way triangles looked does not matter: pieces within others are cavities.
    """
    vertices, joined = np.unique(vertices, axis=0, return_inverse=True)
    triangles = joined.ravel()[triangles]
    triangles = triangles[_spread(vertices, triangles)]
    if not len(triangles):
        raise ValueError(f"{name}: no triangle has an area; must be a closed surface")
    beside, against = _neighbours(name, vertices, triangles)
    piece, turned = _turns(name, triangles, beside, against)
    triangles[turned] = triangles[turned][:, ::-1]
    _check_crossing(name, vertices, triangles)
    used, triangles = np.unique(triangles, return_inverse=True)
    return _outwards(vertices[used], triangles.reshape(-1, 3), piece)


def _spread(vertices, triangles):
    """Which triangles are no lines."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    longest = np.max([np.sum((u - v) ** 2, axis=1) for u, v in ((a, b), (b, c), (c, a))], axis=0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) > THIN * longest


def _neighbours(name, vertices, triangles):
    """The triangle beyond each edge, (m, 3), and whether it runs along it the same way, which neighbours must not."""
    ends = triangles[:, EDGES].reshape(-1, 2)
    keys = np.sort(ends, axis=1) @ [len(vertices), 1]
    order = np.argsort(keys, kind="stable")
    _, start, count = np.unique(keys[order], return_index=True, return_counts=True)
    odd = np.flatnonzero(count != 2)
    if len(odd):
        at = vertices[ends[order[start[odd[0]]]]].mean(axis=0)
        what = "one triangle" if count[odd[0]] == 1 else f"{count[odd[0]]} triangles"
        raise ValueError(
            f"{name}: not closed, {len(odd)} edges do not belong to two triangles; that at "
            f"{tuple(np.round(at, 9).tolist())} m belongs to {what}: must be a closed surface"
        )
    one, other = order[0::2], order[1::2]
    beside, against = np.empty(len(ends), int), np.empty(len(ends), bool)
    beside[one], beside[other] = other // 3, one // 3
    against[one] = against[other] = ends[one, 0] == ends[other, 0]
    return beside.reshape(-1, 3), against.reshape(-1, 3)


def _turns(name, triangles, beside, against):
    """Piece of each triangle, and whether it looks the other way than the first of its piece."""
    piece, turned = np.full(len(triangles), -1), np.zeros(len(triangles), bool)
    for first in range(len(triangles)):
        if piece[first] >= 0:
            continue
        number, rim = piece.max() + 1, np.array([first])
        piece[first] = number
        while len(rim):
            reached, way = beside[rim].ravel(), (turned[rim, None] ^ against[rim]).ravel()
            new = piece[reached] < 0
            turned[reached[new]], piece[reached[new]] = way[new], number
            rim = np.unique(reached[new])
    if np.any(turned[beside] != (turned[:, None] ^ against)):
        raise ValueError(f"{name}: has one side only, as a Klein bottle has; must part inside from outside")
    return piece, turned


def _outwards(vertices, triangles, piece) -> Triangles:
    """The surface with every piece turned so that what lies between pieces is inside."""
    for number in range(piece.max() + 1):
        mine = piece == number
        volume = Triangles(vertices, triangles[mine]).volume
        depth = 0
        for other in range(piece.max() + 1):
            if other != number:
                around = Triangles(vertices, triangles[piece == other])
                depth += int(around.holds(vertices[triangles[mine][:1, 0]])[0])
        if (volume > 0) != (depth % 2 == 0):
            triangles[mine] = triangles[mine][:, ::-1]
    return Triangles(vertices, triangles)


def _check_crossing(name, vertices, triangles):
    """Raise ValueError where two triangles that share no corner cross."""
    for one, other in _close(vertices, triangles):
        apart = ~np.any(triangles[one][:, :, None] == triangles[other][:, None, :], axis=(1, 2))
        one, other = one[apart], other[apart]
        crossed = np.zeros(len(one), bool)
        for here, there in ((one, other), (other, one)):
            corners = vertices[triangles[there]]
            for a, b in EDGES:
                crossed |= _pierced(vertices[triangles[here][:, a]], vertices[triangles[here][:, b]], corners)
        if crossed.any():
            at = vertices[triangles[one[np.argmax(crossed)]]].mean(axis=0)
            raise ValueError(
                f"{name}: crosses itself near {tuple(np.round(at, 9).tolist())} m; must be a surface that does not"
            )


def _close(vertices, triangles):
    """Pairs of triangles whose balls meet, block by block."""
    from scipy.spatial import cKDTree

    corners = vertices[triangles]
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    tree = cKDTree(middles)
    many = tree.query_ball_point(middles, radii + radii.max(), return_length=True)
    ends = np.cumsum(many)
    start = 0
    while start < len(middles):
        stop = max(start + 1, int(np.searchsorted(ends, (ends[start - 1] if start else 0) + PAIRS)))
        found = tree.query_ball_point(middles[start:stop], radii[start:stop] + radii.max())
        one, other = np.repeat(np.arange(start, start + len(found)), [len(f) for f in found]), np.concatenate(found)
        other = other.astype(int)
        near = (one < other) & (np.linalg.norm(middles[one] - middles[other], axis=1) < radii[one] + radii[other])
        yield one[near], other[near]
        start = stop


def _pierced(p, q, corners):
    """Whether lines from p to q pass through triangles."""
    a, b, c = np.moveaxis(corners, 1, 0)

    def side(u, v, w, x):
        return np.einsum("ij,ij->i", np.cross(v - u, w - u), x - u)

    through = side(a, b, c, p) * side(a, b, c, q) < 0
    signs = np.stack([side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)])
    return through & (np.all(signs > 0, axis=0) | np.all(signs < 0, axis=0))
