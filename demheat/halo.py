"""Old place of `demheat.sampling.halo`."""

import warnings

from demheat.sampling.halo import halo_flux

__all__ = ["halo_flux"]
warnings.warn("demheat.halo is now demheat.sampling.halo", DeprecationWarning, stacklevel=2)
