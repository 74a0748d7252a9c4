"""Layers at any angle to the axes: the full tensor of a laminate.

Source: Milton, The Theory of Composites (2002), section 9.2. Along the layers all gradients are the mean one, across
them all fluxes are.
"""

import numpy as np


def laminate(conductivities, shares, normal, *, resistance=0.0) -> np.ndarray:
    """Effective conductivity of a periodic stack of layers, a (3, 3) float array.

    Parameters
    ----------
    conductivities : sequence of float or (3, 3) float array, W/(m K)
        Of each layer: a number, or a symmetric tensor, so that what this returns may be layered again.
    shares : sequence of float
        Of the volume; their sum is 1.
    normal : (3,) sequence of float
        Across the layers, of any length but 0.
    resistance : float, m K/W
        Of all interfaces within a length across, over that length.

    Raises
    ------
    ValueError
        If an argument is not as described.

    Examples
    --------
    >>> from references.exact.inclined import laminate
    >>> laminate([1.0, 4.0], [0.5, 0.5], normal=(1, 1, 0)).round(9).tolist()
    [[2.05, -0.45, 0.0], [-0.45, 2.05, 0.0], [0.0, 0.0, 2.5]]
    """
    tensors = [_checked_tensor(each) for each in conductivities]
    shares = _checked_shares(shares, len(tensors))
    n = np.asarray(normal, dtype=float)
    if n.shape != (3,) or not np.all(np.isfinite(n)) or not n.any():
        raise ValueError(f"normal = {normal!r}: must be three finite numbers, not all 0")
    if not 0 <= resistance < np.inf:
        raise ValueError(f"resistance = {resistance!r}: must be a finite number >= 0 m K/W")
    n = n / np.linalg.norm(n)
    # A mean flux q across makes the gradient -q/across in a layer, and leaves it `bent` along the layers.
    across = np.array([n @ k @ n for k in tensors])
    bent = [k @ n / own if own > 0 else 0.0 * n for k, own in zip(tensors, across, strict=True)]
    # What a layer carries along itself while nothing flows across.
    along = [k - own * np.outer(v, v) for k, own, v in zip(tensors, across, bent, strict=True)]
    if np.any(across[shares > 0] == 0):
        return np.einsum("i,ijk->jk", shares, along)
    used = shares > 0
    total = 1 / (np.sum(shares[used] / across[used]) + resistance)
    mean = shares @ np.array(bent)
    return np.einsum("i,ijk->jk", shares, along) + total * np.outer(mean, mean)


def _checked_tensor(value):
    found = np.asarray(value, dtype=float)
    found = found * np.eye(3) if found.ndim == 0 else found
    fits = found.shape == (3, 3) and np.all(np.isfinite(found))
    # Symmetric and not negative, both to rounding.
    slack = 1e-12 * np.abs(found).max() if fits else 0.0
    if not fits or np.abs(found - found.T).max() > slack or np.linalg.eigvalsh(found).min() < -slack:
        raise ValueError(
            f"conductivities: {value!r} must be a finite number >= 0 or a symmetric tensor without negative ones"
        )
    return found


def _checked_shares(shares, layers):
    found = np.asarray(shares, dtype=float)
    if found.shape != (layers,) or not np.all(found >= 0) or abs(found.sum() - 1) > 1e-12:
        raise ValueError(f"shares = {shares!r}: must be {layers} numbers >= 0 with the sum 1, one of each layer")
    return found
