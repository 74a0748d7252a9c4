"""Means of a body's values in equal slices across one axis."""

import numpy as np


def slice_means(place, values, bins=20):
    """Middles of the slices, and means of values in them."""
    edges = np.linspace(0.0, 1.0, bins + 1)
    here = np.clip(np.digitize(place, edges) - 1, 0, bins - 1)
    count = np.bincount(here, minlength=bins)
    mean = np.full(bins, np.nan)
    np.divide(np.bincount(here, values, bins), count, out=mean, where=count > 0)
    return (edges[1:] + edges[:-1]) / 2, mean
