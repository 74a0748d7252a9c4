"""Integrators of a network in time, each in its own module with its declared `ORDER`."""
