"""Homogenisation on voxels by fast Fourier transforms: Eyre and Milton's scheme, and a faster scalar one.

The only home of pyFFTW.
"""

from typing import TYPE_CHECKING

from demheat.method import CUT, OVERSHOOT, VOXELS, Errors, Method, Orders
from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from references.fft.solver import solve, solve_axes

__all__ = ["solve", "solve_axes"]

SIZED = {"resolution": VOXELS, "small": 16, "coarse": 24, "tight": {"tolerance": 1e-9, "threads": 1}}
SERIES = {"potential": "its temperature is a truncated Fourier series"}
SINGULAR = {"pores": "laminates of pore and solid need a thousand iterations; by default voxels are plain"}
PAIR = {"flux": "Scene.walls"}
PORES = {"pores": "conductivity is 0"}
METHODS = (
    Method(
        name="fft",
        title="FFT, scalar",
        label="FFT, scalar CG, laminate voxels",
        knobs={"scheme": "cg", "rule": "laminate"},
        **SIZED,
        errors=Errors(2e-3, 3.3e-3, 0.1),
        # Laminates in the cut layer: first order in the end, but with a small factor; found 1.9, 1.6, 0.9.
        orders=Orders((12, 17, 24, 32), 1.3, 1.0, 0.4, repeats=2),
        # They lose the size itself in the end, its square before that, while few voxels lie across a gap.
        terms=(1.0, 2.0),
        exceptions=OVERSHOOT | SINGULAR,
        refuses=PAIR,
        look=("green", "D", "-"),
    ),
    Method(
        name="fft-plain",
        title="FFT, scalar, plain voxels",
        label="FFT, scalar CG, plain voxels",
        role="beside",
        knobs={"scheme": "cg", "rule": "plain"},
        **SIZED,
        errors=Errors(1.5e-2, 3.5e-3, 0.17),
        # Plain voxels: as particles across the interface; found 1.0, 1.0, 0.6.
        orders=Orders((12, 17, 24, 32), 0.6, 0.7, 0.3, repeats=3),
        exceptions=OVERSHOOT | CUT,
        refuses=PAIR,
        look=("green", "D", ":"),
    ),
    Method(
        name="fft-links",
        title="FFT, scalar, links",
        label="FFT, scalar CG, links cut at interfaces",
        role="beside",
        knobs={"scheme": "cg", "rule": "links"},
        **SIZED,
        errors=Errors(1.4e-2, 2.7e-3, 0.13),
        # Links cut at the surface; found 1.6, 2.0, 0.9.
        orders=Orders((12, 17, 24, 32), 1.2, 1.2, 0.4, contrast=100.0, repeats=2),
        exceptions=CUT,
        refuses=PAIR | PORES,
        look=("green", "D", "--"),
    ),
    Method(
        name="fft-em",
        title="FFT, Eyre-Milton",
        label="FFT, Eyre-Milton, laminate voxels",
        knobs={"scheme": "eyre-milton", "rule": "laminate"},
        **SIZED,
        errors=Errors(2e-3, 3e-3, 0.1),
        # As the scalar scheme's, of the same laminates.
        orders=Orders((12, 17, 24, 32), 1.3, 1.0, 0.4, repeats=2),
        terms=(1.0, 2.0),
        exceptions=OVERSHOOT | SERIES,
        refuses=PAIR | PORES,
        look=("black", "x", "-"),
    ),
    Method(
        name="fft-em-plain",
        title="FFT, Eyre-Milton, plain voxels",
        role="beside",
        knobs={"scheme": "eyre-milton", "rule": "plain"},
        **SIZED,
        errors=Errors(1.4e-2, 4e-3, 0.18),
        exceptions=OVERSHOOT | CUT | {"orders": "those of the scalar scheme on the same voxels"},
        refuses=PAIR | PORES,
        look=("black", "x", ":"),
    ),
)

# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, {"references.fft.solver": ("solve", "solve_axes")})
