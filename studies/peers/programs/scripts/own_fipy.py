"""A case of FiPy's own manual: a bar of three pieces, held at one end, a flux through the other."""

import json
import os

os.environ.setdefault("FIPY_SOLVERS", "scipy")
from fipy import CellVariable, DiffusionTerm, FaceVariable, Grid1D  # noqa: E402

mesh = Grid1D(nx=50, dx=1.0)
length = 50.0
x = mesh.faceCenters[0]
conductivity = FaceVariable(mesh=mesh, value=1.0)
conductivity.setValue(0.1, where=(length / 4 <= x) & (x < 3 * length / 4))
t = CellVariable(mesh=mesh, value=0.0)
t.faceGrad.constrain([1.0], mesh.facesRight)
t.constrain(0.0, mesh.facesLeft)
DiffusionTerm(coeff=conductivity).solve(var=t)
print(json.dumps({"value": float(t.value[-1])}))
