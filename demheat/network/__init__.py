"""Transmission surfaces, interface rules and the network they make."""
