"""The third-order parameter by voxels, see `references.fft.zeta2`."""

from references.fft.zeta2 import zeta2

__all__ = ["zeta2"]
