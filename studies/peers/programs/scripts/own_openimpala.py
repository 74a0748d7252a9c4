"""The homogeneous cube of OpenImpala's manual, whose tortuosity stands there: prints one JSON object."""

import json

import numpy as np
import openimpala

with openimpala.Session():
    found = openimpala.tortuosity(np.zeros((16, 16, 16), dtype=np.int32), phase=0, direction="x", solver="pcg")
# AMReX prints a profile as the session ends.
print("\n" + json.dumps({"value": found.tortuosity}))
