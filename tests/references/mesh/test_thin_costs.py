"""What thin layers and coats cost is known within a factor of two before a mesh is begun, and refused if too much."""

import numpy as np
import pytest

from demheat import Layer, Material, Scene, Sphere
from references import fem
from references.mesh import make
from references.mesh.sizes import estimated_cells, wanted_sizes

METAL, OTHER = Material(1.0), Material(5.0)


def cell(*inclusions, size=(1.0, 0.8, 0.9)):
    return Scene(size, METAL, inclusions, gradient=(1.0, 0.0, 0.0))


def layers(*ends):
    return cell(*(Layer(0, *pair, OTHER) for pair in ends))


def coated(radius, thickness):
    balls = (Sphere((0.5, 0.5, 0.5), r, m) for r, m in ((radius, OTHER), (radius - thickness, METAL)))
    return cell(*balls, size=(1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("scene", "size"),
    [
        (layers((0.3, 0.35), (0.37, 0.4)), 0.12),
        pytest.param(coated(0.3, 0.01), 0.16, marks=pytest.mark.slow),
        pytest.param(coated(0.3, 0.02), 0.16, marks=pytest.mark.slow),
    ],
)
def test_estimate_is_within_a_factor_of_two(scene, size):
    made = len(make(scene, size=size, order=1).cells)
    assert made / 2 < estimated_cells(wanted_sizes(scene, size), np.array(scene.size)) < 2 * made


@pytest.mark.parametrize("scene", [layers((0.3, 0.3002)), coated(0.3, 1e-4)])
def test_hopeless_meshes_are_refused_before_they_are_begun(scene):
    with pytest.raises(ValueError, match=r"about \d.* tetrahedra"):
        fem.solve(scene, size=0.2)
