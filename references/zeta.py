"""The third-order parameter by voxels, see `references.fft.zeta`."""

from references.fft.zeta import zeta2

__all__ = ["zeta2"]
