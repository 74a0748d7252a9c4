"""Bodies in a geometry of OpenCASCADE, which gmsh hands over: turned and moved to where they belong."""

import numpy as np

# Axis and angle, rad, of a turn that leaves no seam or pole in a plane of symmetry, which may be a face of the box.
GENERIC = (1.0, 2.0, 3.0, 1.0)


def placed(occ, tag: int, rotation, center) -> int:
    """Turn a body at the origin, by a matrix, and move it to a centre."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(np.array(rotation)).as_rotvec()
    angle = float(np.linalg.norm(turn))
    if angle > 0:
        occ.rotate([(3, tag)], 0, 0, 0, *(turn / angle), angle)
    occ.translate([(3, tag)], *center)
    return tag
