"""Speed against error on one scene whose conductivity is known exactly: a sphere ten times as conducting in a cube.

python examples/speed_against_error.py
"""

import time
from functools import partial

from demheat import gallery, solve
from references import exact, fem, fft

scene = gallery.sphere_in_cube(10.0)
right = exact.solve(scene).conductivity
ways = [
    *(("DEM", f"particles = {n}", partial(solve, particles=n)) for n in (1_000, 3_000, 9_000)),
    *(("FEM", f"size = {h}", partial(fem.solve, size=h)) for h in (0.02, 0.014, 0.01)),
    *(("FFT", f"voxels = {n}", partial(fft.solve, voxels=n)) for n in (16, 32, 64)),
]
for _, _, method in ways[::3]:
    method(scene)  # what is compiled or loaded once is not what is compared

print(f"exact conductivity {right:.6f} W/(m K)")
print("method  knob                 error, %  unknowns  seconds")
for name, knob, method in ways:
    begun = time.perf_counter()
    field = method(scene)
    seconds = time.perf_counter() - begun
    error = 100 * (field.conductivity / right - 1)
    print(f"{name:6}  {knob:18}  {error:9.4f}  {field.stats['unknowns']:8}  {seconds:7.2f}")
print("The DEM's seconds hold those of its packing, when it is made for the first time.")
