"""Transmission surfaces, interface rules and the network they make."""

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)
