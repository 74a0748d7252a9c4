"""The strip of TauFactor's own tests, whose tortuosity stands there: prints one JSON object."""

import json

import numpy as np
import taufactor

N = 20
steps = np.zeros((N, N + 1, N + 1))
for i in range(N):
    steps[i, i : i + 2, i : i + 2] = 1
solver = taufactor.Solver(steps, device="cpu")
solver.solve(verbose=False)
print(json.dumps({"value": float(solver.tau[0])}))
