"""The matrix is scikit-fem's; any point is found in its element, among small ones, near gaps and on faces, too."""

import numpy as np
import pytest
from fem_scenes import COARSE, ELEMENTS, ball, points_in, scene
from numpy.testing import assert_allclose
from skfem import Basis, BilinearForm, MeshTet1, MeshTet2
from skfem.element import ElementTetP1, ElementTetP2
from skfem.helpers import dot, grad

from references import fem, mesh
from references.fem import lookup
from references.fem.elements import assemble
from references.fem.lookup import NodalField

# ---------------------------------------------------------------- fields


@pytest.mark.parametrize("knobs", ELEMENTS)
@pytest.mark.parametrize("load", [{"walls": {"y-": 0.0, "y+": 1.0}}, {"gradient": (0.0, 1.0, 0.0)}])
def test_samples_are_the_field(knobs, load):
    of = scene(ball(10.0, (0.5, 0.45, 0.6)), **load)
    field = fem.solve(of, size=COARSE, **knobs)
    samples = field.samples
    assert np.all(samples.volumes > 0)
    assert_allclose(samples.volumes.sum(), 1.0, rtol=1e-12)
    assert_allclose(np.bincount(samples.phase, samples.volumes), field.fractions, rtol=1e-12)
    # The flux is a cubic over each curved element, integrated exactly: rounding.
    assert_allclose(samples.volumes @ samples.flux, field.mean_flux, atol=1e-12)
    some = np.random.default_rng(0).integers(0, len(samples.volumes), 1000)
    assert_allclose(field.temperature_at(samples.points[some]), samples.temperature[some], atol=1e-12)
    assert_allclose(field.flux_at(samples.points[some]), samples.flux[some], atol=1e-9)


def test_lookup_among_elements_of_very_different_size():
    of = scene(ball(10.0, (0.5, 0.5, 0.52), 0.47), ball(1.0, (0.93, 0.93, 0.93), 0.01))
    made = mesh.make(of, size=0.2)
    assert made.volumes.max() > 1e4 * made.volumes.min()
    linear = NodalField(of, made, made.points @ np.array([1.0, 2.0, 3.0]))
    rng = np.random.default_rng(0)
    near = 0.93 + 0.02 * rng.standard_normal((300, 3))
    gap = rng.random((300, 3)) * (1, 1, 0) + (0, 0, 0.995)
    points = np.vstack([near, gap, made.points, points_in((1, 1, 1))])
    assert_allclose(linear.temperature_at(points), points @ np.array([1.0, 2.0, 3.0]), atol=1e-9)  # INSIDE
    assert_allclose(linear.flux_at(near) / linear.flux_at(near)[:, :1], np.tile([1.0, 2.0, 3.0], (300, 1)), rtol=1e-8)


def test_lookup_finds_what_the_nearest_centres_miss(monkeypatch):
    field = fem.solve(scene(ball(10.0)), size=COARSE)
    points = points_in((1, 1, 1), 60)
    expected = field.temperature_at(points)
    monkeypatch.setattr(lookup, "NEAREST", (1,))
    assert_allclose(field.temperature_at(points), expected, atol=1e-9)  # continuous: either of two elements
    monkeypatch.setattr(NodalField, "_bounds", property(lambda self: (np.full((1, 3), 2.0), np.full((1, 3), 2.0))))
    with pytest.raises(RuntimeError, match="no element contains"):
        field.temperature_at(points)


# ---------------------------------------------------------------- against scikit-fem


@pytest.mark.parametrize("order", [1, 2])
def test_the_matrix_is_that_of_scikit_fem(order):
    of = scene(ball(10.0))
    made = mesh.make(of, order=order, size=0.25)
    conductivity = of.conductivities[made.phase]
    corners, flat = np.unique(made.cells[:, :4], return_inverse=True)
    plain = MeshTet1(made.points[corners].T, flat.reshape(-1, 4).T.astype(np.int32))
    theirs, element = (plain, ElementTetP1()) if order == 1 else (MeshTet2.from_mesh(plain), ElementTetP2())
    row = np.empty(len(made.points), int)
    nodes = theirs.dofs.element_dofs
    row[made.cells] = nodes.T
    theirs.doflocs[:, row] = made.points.T
    basis = Basis(theirs, element, intorder=5)

    @BilinearForm
    def conduct(u, v, w):
        return w.k * dot(grad(u), grad(v))

    expected = conduct.assemble(basis, k=np.repeat(conductivity[:, None], basis.W.size, axis=1))[row][:, row]
    matrix, load = assemble(made, conductivity, np.arange(len(row)), made.points[:, 0])
    # Straight elements: both quadratures are exact; curved ones: the same points. Rounding.
    rounding = 1e-12 * abs(expected).max()
    assert abs(matrix - expected).max() < rounding
    assert_allclose(load, -matrix @ made.points[:, 0], atol=rounding)
