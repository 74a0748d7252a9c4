"""Heat through a network: steady balances, marches in time, sources."""

import demheat.runtime.compiled  # noqa: F401 (where compiled kernels are kept)
