"""Temperature and flux anywhere, from what a solved network knows at its particles."""

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)
