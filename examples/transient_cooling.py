"""Cooling in time: an aluminium ball at 200 C whose surface is held at 20 C, beside the exact series.

python examples/transient_cooling.py
"""

from demheat import Material, Scene, evolve
from references import series

density, heat_capacity = 2700.0, 900.0
aluminium = Material(185.0, density=density, heat_capacity=heat_capacity)
ball = Scene((0.1, 0.1, 0.1), aluminium, domain="sphere", walls={"round": 20.0}, initial=200.0)
middle = [0.05, 0.05, 0.05]
times = [1.0, 2.0, 5.0, 10.0, 20.0]

print("time, s   DEM, C   exact, C   heat out so far, kJ")
held = density * heat_capacity * ball.volume * 180.0
for field, right in zip(evolve(ball, times, particles=5_000), series.evolve(ball, times), strict=True):
    mean = (field.samples.temperature * field.samples.volumes).sum() / field.samples.volumes.sum()
    heat = density * heat_capacity * ball.volume * (200.0 - mean)
    (dem,), (exact,) = field.temperature_at(middle), right.temperature_at(middle)
    print(f"{field.time:7.1f}  {dem:7.2f}  {exact:9.2f}  {heat / 1e3:10.2f} of {held / 1e3:.2f}")
print(f"{field.stats['integrator']}, chosen by cost; {field.stats['unknowns']} unknowns")
