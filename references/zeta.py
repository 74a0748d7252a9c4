"""The third-order parameter by voxels, see `references.fft.zeta`."""

from demheat.runtime.extras import extra

with extra(__name__):
    from references.fft.zeta import zeta2

__all__ = ["zeta2"]
