"""Square patterns in the plane with closed forms: the checkerboard, and square rods on a quarter of the area.

Both are across rods that are endless along z, and isotropic there; conductivities are over that of one phase.
"""

import math


def checkerboard(contrast) -> float:
    """Conductivity of a checkerboard, the root of the contrast (Keller 1964, Dykhne 1970: it is its own dual).

    Parameters
    ----------
    contrast : float
        Of one phase over the other, a finite number >= 0.

    Raises
    ------
    ValueError
        If it is not.

    Examples
    --------
    >>> from references.exact.squares import checkerboard
    >>> checkerboard(4.0)
    2.0
    """
    return math.sqrt(_checked(contrast))


def square_rods(contrast) -> float:
    """Conductivity across square rods in a square array, a quarter of the area, over that of the matrix.

    Obnosov, SIAM J. Appl. Math. 59 (1999) 1267: sqrt((1 + 3 s)/(3 + s)). The sides of a rod are half those of the cell.

    Parameters
    ----------
    contrast : float
        Of the rods over the matrix, 0 to infinity (inclusive).

    Raises
    ------
    ValueError
        If it is not.

    Examples
    --------
    >>> from references.exact.squares import square_rods
    >>> print(f"{square_rods(4.0):.6f} {square_rods(0.25) * square_rods(4.0):.6f}")  # Keller
    1.362770 1.000000
    """
    s = _checked(contrast, endless=True)
    return math.sqrt(3.0) if math.isinf(s) else math.sqrt((1 + 3 * s) / (3 + s))


def _checked(contrast, *, endless=False):
    if not (contrast >= 0 and (endless or math.isfinite(contrast))):
        raise ValueError(f"contrast = {contrast!r}: must be a{'' if endless else ' finite'} number >= 0")
    return float(contrast)
