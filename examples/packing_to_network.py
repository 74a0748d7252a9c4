"""From a packing to its network to a file for ParaView: spheres with temperatures, links with what they conduct.

python examples/packing_to_network.py [folder]
"""

import sys
from pathlib import Path

from demheat import Calibrated, Material, Scene, solve
from demheat.dem.networks import network_of
from demheat.io import packings
from demheat.packing import contacts, statistics
from demheat.packing.lsa import lsa

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
scene = Scene((1.0, 1.0, 1.0), Material(1.0), gradient=(0, 1, 0))
packing = lsa(500, phi=0.6, seed=0)  # hard spheres that grow in a periodic cell
indptr, indices, gap = contacts(packing, coordination=7.5)
print(f"{packing.number} spheres fill {packing.phi:.3f}; linked within {100 * gap:.1f} % of the sum of radii")
found = statistics.coordination(packing, indptr, indices)
print(f"links of a sphere: {found.mean:.2f} on average, {found.least} at least")

law = Calibrated(coordination=7.5)
network = network_of(scene, packing, law)
field = solve(scene, law=law, packing=packing)
print(f"C_t = {field.stats['calibration']:.4f}, conductivity {field.conductivity:.6f} of 1")

path = folder / "network.vtp"
packings.write(packing, path, network=network)
print(f"{path.name}: {len(network.indices) // 2} links, {path.stat().st_size // 1024} KiB")
