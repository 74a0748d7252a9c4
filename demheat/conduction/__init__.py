"""Heat through a network: steady balances, marches in time, sources."""
