"""Open space by PoreSpy's `tortuosity_fd`, whose tortuosity its makers state: prints one JSON object."""

import json

import numpy as np
import openpnm
from porespy.simulations import tortuosity_fd

openpnm.Workspace().settings.loglevel = 50
# Its default leaves 2e-5.
found = tortuosity_fd(np.ones((10, 10, 10), dtype=bool), axis=0, tol=1e-10)
print(json.dumps({"value": float(found.tortuosity)}))
