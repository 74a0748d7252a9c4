"""The links of a network as lines between the spheres of a packing."""

from typing import NamedTuple

import numpy as np

from demheat.scene.inputs import reals

# Code of the image that is the particle itself, see demheat.network.base.Facets.
NO_SHIFT = 13
NEEDED = ("centers", "indptr", "indices", "image", "conductance")


class Segments(NamedTuple):
    """What is drawn of a network and of temperatures."""

    ends: np.ndarray  # (m, 2) int array: Particles p < q of each line
    conductance: np.ndarray  # (m,) float array, W/K
    heat_flow: np.ndarray | None  # (m,) float array, W, or None: H (T_q - T_p)
    cut: int  # Number of links to periodic images, not drawn
    temperature: np.ndarray | None  # (n,) float array or None


def segments_of(packing, network, temperature) -> Segments | None:
    """Check what `demheat.io.packings.write` was given and choose the lines."""
    if temperature is not None:
        temperature = _temperatures(temperature, packing.number)
    if network is None:
        empty = np.zeros(0)
        return None if temperature is None else Segments(np.zeros((0, 2), int), empty, None, 0, temperature)
    lacking = [name for name in NEEDED if not hasattr(network, name)]
    if lacking:
        raise ValueError(f"network = {type(network).__name__}: must be a Network; it has no {', '.join(lacking)}")
    if not np.array_equal(network.centers, packing.centers):
        raise ValueError(
            f"network.centers of shape {np.shape(network.centers)}: must be packing.centers, "
            f"{packing.centers.shape}: the network of this packing, in its order"
        )
    rows = np.repeat(np.arange(packing.number), np.diff(network.indptr))
    others, here = np.asarray(network.indices).astype(np.int64), np.asarray(network.image) == NO_SHIFT
    # Each link stands in the rows of both ends.
    once = here & (others > rows)
    ends, conductance = np.column_stack((rows[once], others[once])), np.asarray(network.conductance)[once]
    flow = None if temperature is None else conductance * (temperature[ends[:, 1]] - temperature[ends[:, 0]])
    return Segments(ends, conductance, flow, int(np.count_nonzero(~here)) // 2, temperature)


def _temperatures(temperature, number):
    array = reals("temperature", temperature, f"{number} numbers, one per sphere")
    if array.shape != (number,) or np.any(np.isinf(array)):
        raise ValueError(f"temperature of shape {array.shape}: must be {number} numbers, one per sphere, none infinite")
    return array
