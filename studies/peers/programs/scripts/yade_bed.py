"""Steps of a bed of grains by Yade's ThermalEngine, run by `yade -n -x`: bed.json in, found.json out."""

# ruff: noqa: F403, F405, B905 (as scripts of Yade do: O, Vector3 and the engines; Python of the system)
import json
import sys

from yade import *

with open("bed.json") as stream:
    given = json.load(stream)
# Where this file lies: Yade runs it from its own.
sys.path.insert(0, given["scripts"])
from spent import Spent

wide = 2 * max(given["radii"])
O.materials.append(FrictMat(young=1e6, poisson=0.3, frictionAngle=0, density=given["density"], label="grains"))
low, high = Vector3(-wide, -wide, -wide), Vector3(*[side + wide for side in given["size"]])
O.bodies.append(aabbWalls([low, high], thickness=0, material="grains"))
numbers = [
    O.bodies.append(sphere(center, radius, material="grains"))
    for center, radius in zip(given["centers"], given["radii"])
]
for body in O.bodies:
    body.dynamic = False
flow = FlowEngine(label="flow", multithread=False)
flow.bndCondIsPressure = [1, 1, 0, 0, 0, 0]
thermal = ThermalEngine(label="thermal")
for name in ("thermoMech", "advection", "fluidThermoMech", "solidThermoMech", "fluidConduction"):
    setattr(thermal, name, False)
thermal.conduction, thermal.tsSafetyFactor, thermal.particleT0 = True, 0, 0.0
thermal.bndCondIsTemperature, thermal.thermalBndCondValue = [0] * 6, [0] * 6
thermal.particleDensity, thermal.particleCp, thermal.useKernMethod = given["density"], given["capacity"], given["kern"]
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    ),
    flow,
    thermal,
    NewtonIntegrator(),
]
O.dt = given["step"]
# The heat engine asks the flow engine for the bounds, once.
flow.updateTriangulation = True
flow.emulateAction()
flow.dead = True
O.step()
states = [O.bodies[number].state for number in numbers]
for state, solid, held in zip(states, given["solid"], given["held"]):
    state.k = solid
    if held is not None:
        state.Tcondition, state.temp, state.boundaryId = True, held, 0 if held else 1


clock = Spent()
O.run(given["count"], True)
cost = clock.so_far()
with open("found.json", "w") as stream:
    heat = [-float(thermal.thermalBndFlux[0]), float(thermal.thermalBndFlux[1])]
    json.dump({"cost": cost, "heat": heat, "warmth": [float(state.temp) for state in states]}, stream)
