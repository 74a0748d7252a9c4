"""A composite of your own: glass and copper beads of two sizes in epoxy, by three methods and between bounds.

python examples/own_composite.py
"""

from dataclasses import replace

import numpy as np

from demheat import Material, Scene, Sphere, gallery, solve
from references import bounds, fft, multipole

epoxy, glass, copper = Material(0.195), Material(1.05), Material(400.0)
# Positions and radii of a ready scene; every fourth bead becomes copper, the others glass.
drawn = gallery.dispersion(24, fraction=0.25, ratio=2.0, gap=0.1, edge=1.0, seed=0).inclusions
beads = [bead for bead in drawn if isinstance(bead, Sphere)]
beads = [replace(bead, material=copper if number % 4 == 0 else glass) for number, bead in enumerate(beads)]
scene = Scene((1.0, 1.0, 1.0), epoxy, beads, gradient=(0, 1, 0))

volumes = np.array([4 / 3 * np.pi * bead.radius**3 for bead in beads])
parts = [1 - volumes.sum(), volumes.sum() - volumes[::4].sum(), volumes[::4].sum()]
print("epoxy {:.3f}, glass {:.3f}, copper {:.3f} of the volume".format(*parts))
k = [each.conductivity for each in (epoxy, glass, copper)]
print(f"bounds of any body  {bounds.reuss(k, parts):.4f} to {bounds.voigt(k, parts):.1f} W/(m K)")
print(f"multipoles          {multipole.solve(scene).conductivity:.4f}")
print(f"FFT, 64 voxels      {fft.solve(scene, voxels=64).conductivity:.4f}")
field = solve(scene, particles=10_000)
print(f"DEM                 {field.conductivity:.4f}")
print(f"the DEM sees {1 - field.fractions[0]:.4f} of beads; {field.stats['unknowns']} unknowns")
