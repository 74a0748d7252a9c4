"""A bed of 120 steel balls in air, out of a dump of LIGGGHTS: its conductivity, and the heat of each pair as a table.

    python examples/settled_bed.py

The dump has the header that LIGGGHTS writes, periodic across x and y, in millimetres; the balls, of a millimetre or so,
were pressed together until they balanced. Air conducts 0.026, steel 16 W/(m K).
"""

from pathlib import Path

from demheat import grains
from demheat.io import packings

path = Path(__file__).with_name("settled_bed.liggghts")
bed = packings.read(path).scaled(1e-3)
air = grains.Gap(conductivity=0.026)
field = grains.solve(bed, 16.0, walls={"z-": 80.0, "z+": 20.0}, contact=grains.Overlap(), gap=air)
print(field.conductivity, "W/(m K)", field.wall_heat)
field.write("settled_bed_flows.csv", ids=packings.ids(path))
