"""From ways of walkers to the conductivity: mean squares in time, less what is known of them.

Over long times a walker's mean square way X along a direction grows as 2 k*/c t, with its mean capacity c. What is
counted is the sum over all lags of products of its steps in time, up to a lag beyond which none is left. Known means
make its scatter smaller: of the leaps M without drift, and of those over the conductivity, R, that of X M is that of X
X, that of X R is 2 t/c, and those of M M, M R and R R are their mean squares leap by leap. For the temperature at a
walker is a martingale that differs from X by less than a period, and its mean product with M is as the mean flux, with
R as the mean gradient. Where a phase does not conduct, its part in the mean gradient is not known, and R is left out.
"""

import numpy as np

# Standard errors of a change that is taken for none.
ENOUGH = 2.0


def ways(record: np.ndarray, directions: np.ndarray) -> list[np.ndarray]:
    """Ways between marks of place, leaps and leaps over conductivities: three (marks - 1, n, d) float arrays."""
    steps = np.diff(record, axis=0)
    return [steps[..., 3 * each : 3 * each + 3] @ directions.T for each in range(3)]


def over_lags(one: np.ndarray, other: np.ndarray, lags: tuple[int, ...]) -> np.ndarray:
    """Sums over all lags up to some of products of steps in time, for each walker, (lags, n, d) float array."""
    count, found = len(one), []
    total = np.einsum("mwd,mwd->wd", one, other)
    for lag in range(1, max(lags) + 1):
        pairs = np.einsum("mwd,mwd->wd", one[:-lag], other[lag:])
        pairs = pairs + (pairs if one is other else np.einsum("mwd,mwd->wd", other[:-lag], one[lag:]))
        total = total + count / (count - lag) * pairs
        if lag in lags:
            found.append(total)
    return np.array(found)


def products(steps: list[np.ndarray], squares: tuple, drift: np.ndarray, lags: tuple[int, ...]) -> np.ndarray:
    """What each walker says, (lags, n, 6) float array: X X, and five sums whose mean is 0, as means over directions.

    `squares` are means of M M, (n,), of M R and of R R, (n, d), m2; `drift`, (n,), is that of X R: twice the time over
    the mean capacity.
    """
    x, leaps, resisted = steps  # (m, n, d) float arrays, m
    xx = over_lags(x, x, lags)
    sums = [
        xx,
        xx - over_lags(x, leaps, lags),
        over_lags(leaps, leaps, lags) - squares[0][:, None],
        over_lags(x, resisted, lags) - drift[:, None],
        over_lags(leaps, resisted, lags) - squares[1],
        over_lags(resisted, resisted, lags) - squares[2],
    ]
    return np.stack([each.mean(axis=2) for each in sums], axis=2)


def fitted(own: np.ndarray) -> np.ndarray:
    """What each walker says of the mean of the first column once what the others explain is taken off, (n,) array."""
    others = own[:, 1:] / np.maximum(np.abs(own[:, 1:]).max(axis=0), np.finfo(float).tiny)
    columns = np.column_stack([np.ones(len(own)), others])
    slopes = np.linalg.lstsq(columns, own[:, 0], rcond=None)[0][1:]
    return own[:, 0] - others @ slopes


def chosen(own: np.ndarray) -> tuple[float, float, int]:
    """The conductivity over the mean capacity, its standard error, and which of the longest lags was enough.

    The least one that no longer one changes by more than twice the standard error of the change (Lepski 1991). What
    the next longer one changes beyond that standard error is counted in the error.
    """
    said = np.array([fitted(each) for each in own])
    mean, root = said.mean(axis=1), np.sqrt(said.shape[1] - 1.0)
    for lag in range(len(said)):
        later = said[lag + 1 :] - said[lag]
        changes, scatter = np.abs(later.mean(axis=1)), later.std(axis=1) / root
        if np.all(changes <= ENOUGH * scatter):
            break
    beyond = max(float(changes[0] - scatter[0]), 0.0) if len(changes) else 0.0
    return float(mean[lag]), float(np.hypot(said[lag].std() / root, beyond)), lag
