"""Interfaces that resist: the conductivity falls with the resistance, and at one value the sphere cannot be seen.

python examples/interface_resistance.py
"""

from dataclasses import replace

from demheat import Sphere, gallery, solve
from references import exact, fem

perfect = gallery.sphere_in_cube(10.0, fraction=0.2)
(sphere,) = (each for each in perfect.inclusions if isinstance(each, Sphere))
k, contrast = perfect.conductivities[0], 10.0
neutral = (contrast - 1) / contrast  # the Kapitza length R k over the radius at which a sphere is as good as matrix

print("R k / a   exact/k      FEM/k      DEM/k")
for length in (0.0, 0.05, 0.5, neutral, 5.0):
    surface = replace(sphere, resistance=length * sphere.radius / k)
    scene = replace(perfect, inclusions=[surface])
    found = [exact.solve(scene), fem.solve(scene, size=0.012), solve(scene, particles=5_000)]
    print(f"{length:7.3f}" + "".join(f"  {field.conductivity / k:9.5f}" for field in found))
print(f"At {neutral:g} heat crosses as if there were no sphere: exactly 1.")
