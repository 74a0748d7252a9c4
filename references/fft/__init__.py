"""Homogenisation on voxels by fast Fourier transforms: Eyre and Milton's scheme, and a faster scalar one.

The only home of pyFFTW.
"""

__all__ = ["solve"]  # noqa: F822, found by `__getattr__`


def __getattr__(name):
    # What is heavy loads with the first call.
    if name == "solve":
        from references.fft.solver import solve

        return solve
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
