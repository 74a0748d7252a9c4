"""zeta_2 by multipoles is that of cubic arrays; orders beyond memory and numbers are refused."""

import math

import pytest
from multipole_scenes import CUBIC, PARTS, box
from numpy.testing import assert_allclose

from demheat import Layer, Material, Scene, Sphere, gallery
from references import multipole
from references.exact import lattice
from references.multipole import third_order


@pytest.mark.parametrize("kind", CUBIC)
def test_zeta2_of_cubic_arrays(kind):
    for fraction in (4 * math.pi / 81, 0.5):
        found = multipole.zeta2(CUBIC[kind](fraction=fraction))
        assert_allclose(found, lattice.zeta2(kind, fraction), rtol=1e-10)  # degrees left out, 1e-11
    if kind == "sc":
        assert_allclose(found, 0.17376, rtol=0, atol=5e-6)  # half a unit of the last digit printed


def test_zeta2_ignores_shifts_and_conductivities():
    parts = [(center, radius, 7.0) for center, radius, _ in PARTS]
    pores = [(center, radius, 0.0) for center, radius, _ in PARTS]
    value = multipole.zeta2(box(parts=parts))
    assert_allclose(multipole.zeta2(box(shift=(0.4, 0.1, -0.3), parts=pores)), value, rtol=1e-10)  # rounding, amplified
    assert 0 < value < 1


def test_zeta2_of_two_materials_or_nothing_is_refused():
    for parts in (PARTS, []):
        with pytest.raises(ValueError, match="one material"):
            multipole.zeta2(box(parts=parts))


def test_zeta2_of_walls_layers_and_nested_spheres_is_refused():
    outer, inner = (Sphere((0.5,) * 3, radius, Material(5.0)) for radius in (0.4, 0.2))
    for parts, load, reason in (
        ([inner], {"walls": {"x-": 0.0, "x+": 1.0}}, "walls"),
        ([Layer(0, 0.2, 0.4, Material(2.0))], {"gradient": (1.0, 0.0, 0.0)}, "a layer"),
        ([outer, inner], {"gradient": (1.0, 0.0, 0.0)}, "nested"),
    ):
        with pytest.raises(NotImplementedError, match=reason):
            multipole.zeta2(Scene((1.0,) * 3, Material(1.0), parts, **load))


@pytest.mark.parametrize("order", [0, True, 81, 160, 5000])
def test_zeta2_refuses_orders_beyond_memory_and_numbers(order):
    with pytest.raises(ValueError, match=f"order = {order}: must be"):
        multipole.zeta2(gallery.simple_cubic(fraction=0.3), order=order)


def test_zeta2_refuses_a_default_order_that_is_too_high(monkeypatch):
    # A sphere of a twentieth of the radius, nearly touching: (1/1.05)^(2 order) = 1e-15 at order 354.
    parts = [((0.5, 0.5, 0.5), 0.3, 2.0), ((0.5, 0.5, 0.816), 0.015, 2.0)]
    with pytest.raises(RuntimeError, match="smallest gap 0.001 m .* needs order .*; 80 is the highest"):
        multipole.zeta2(box(parts=parts))
    assert 0 < multipole.zeta2(box(parts=parts), order=20) < 1
    monkeypatch.setattr(third_order, "MOST_BYTES", 1e4)
    scene = gallery.face_centred(fraction=0.5)
    with pytest.raises(RuntimeError, match="between 4 spheres .* is the highest"):
        multipole.zeta2(scene)
    with pytest.raises(ValueError, match="order = 20: must be <= 10 for 4 spheres"):  # sqrt(2e4/16/7) - 3
        multipole.zeta2(scene, order=20)


def test_zeta2_of_many_spheres_by_cells(monkeypatch):
    scene = gallery.random_dispersion(30, fraction=0.1, gap=0.5, seed=1)
    expected = multipole.zeta2(scene)
    monkeypatch.setattr(third_order, "MANY", 20)
    assert_allclose(multipole.zeta2(scene), expected, rtol=1e-9)  # `third_order.PRECISION`, amplified
