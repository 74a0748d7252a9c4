"""The two halves in a row of PuMA's own tests, whose conductivity stands there: prints one JSON object."""

import json
import os
import tempfile

import numpy as np
import pumapy

labels = np.ones((10, 8, 14))
labels[5:] = 2
phases = pumapy.IsotropicConductivityMap()
phases.add_material((1, 1), 10)
phases.add_material((2, 2), 1)
# It writes logs where it runs.
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    body = pumapy.Workspace.from_array(labels)
    found, *_ = pumapy.compute_thermal_conductivity(body, phases, "x", "p", solver_type="direct")
    os.chdir("/")
print(json.dumps({"value": float(found[0])}))
