"""The rod of Yade's example conductionVerification.py: walls across x at 0, grains at 400 K; bed.json to found.json."""

# ruff: noqa: F403, F405, B905 (as scripts of Yade do: O, Vector3 and the engines; Python of the system)
import json

from yade import *
from yade import pack

with open("bed.json") as stream:
    given = json.load(stream)
low, high = Vector3(0, 0, 0), Vector3(1.0, 0.008, 0.008)
O.materials.append(FrictMat(young=1e6, poisson=0.5, frictionAngle=radians(3), density=2600, label="spheres"))
O.materials.append(FrictMat(young=1e6, poisson=0.5, frictionAngle=0, density=0, label="walls"))
O.bodies.append(aabbWalls([low, high], thickness=0, material="walls"))
numbers = O.bodies.append(pack.regularOrtho(pack.inAlignedBox(low, high), radius=0.003, gap=-1e-8, material="spheres"))
for number in numbers:
    O.bodies[number].dynamic = False
flow, thermal = FlowEngine(multithread=False), ThermalEngine()
thermal.conduction, thermal.particleT0, thermal.tsSafetyFactor = True, 400.0, 0
for name in ("thermoMech", "advection", "fluidThermoMech", "solidThermoMech", "fluidConduction"):
    setattr(thermal, name, False)
thermal.bndCondIsTemperature, thermal.thermalBndCondValue = [1, 1, 0, 0, 0, 0], [0] * 6
thermal.particleDensity, thermal.particleCp, thermal.particleK, thermal.useKernMethod = 2600, 710.0, 2.0, False
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
    NewtonIntegrator(damping=0.2),
]
flow.updateTriangulation, O.dt = True, given["step"]
flow.emulateAction()
flow.dead = True
O.run(given["count"], True)
with open("found.json", "w") as stream:
    grains = [O.bodies[number].state for number in numbers]
    json.dump({"x": [float(g.pos[0]) for g in grains], "warmth": [float(g.temp) for g in grains]}, stream)
