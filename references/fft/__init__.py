"""Homogenisation on voxels by fast Fourier transforms."""

from references.fft.solver import solve

__all__ = ["solve"]
