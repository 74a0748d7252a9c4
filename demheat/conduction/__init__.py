"""Heat through a network: steady balances, marches in time, sources."""

import demheat.compiled  # noqa: F401 (where compiled kernels are kept)
