"""Only here: tensors of users turned the other way, or mirrored where they have no mirror."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from demheat import Layer, Material, Scene, Sphere, orthotropic
from demheat.scene.symmetry import alike_axes, mirrors
from demheat.scene.turned import turned

TURN = (0.3, -0.5, 0.8)


def test_principal_conductivities_are_turned():
    turn = Rotation.from_rotvec(TURN).as_matrix()
    tensor = np.array(orthotropic(1, 4, 9, rotation=TURN))
    assert_allclose(tensor, turn @ np.diag([1, 4, 9]) @ turn.T, atol=1e-14)
    assert_allclose(np.array(orthotropic(1, 4, 9, rotation=turn)), tensor, atol=1e-14)
    assert orthotropic(1, 4, 9) == orthotropic(1, 4, 9, rotation=(0, 0, 0)) == ((1, 0, 0), (0, 4, 0), (0, 0, 9))


def test_a_tensor_that_is_the_same_all_round_is_a_number():
    assert Material(2 * np.eye(3)) == Material(2.0) and Material(np.zeros((3, 3))).conductivity == 0.0
    assert Material(np.diag([1, 1, 2])).isotropic is False


def test_materials_can_be_compared_kept_and_stored():
    own = Material(orthotropic(1, 2, 3, rotation=TURN))
    assert own == Material(np.array(own.conductivity)) and hash(own) == hash(Material(own.conductivity))
    assert pickle.loads(pickle.dumps(own)) == own
    # Rounding of a user's own product is taken off.
    off = np.array(own.conductivity)
    off[0, 1] *= 1 + 1e-14
    assert Material(off).tensor[0, 1] == Material(off).tensor[1, 0]


def scene(**load):
    shapes = [Layer(1, 0.2, 0.4, Material(5.0)), Sphere((0.5, 0.7, 0.5), 0.2, Material(orthotropic(1, 2, 3)))]
    return Scene((1.0, 1.0, 1.0), Material(0.1), shapes, **(load or {"gradient": (1.0, 0.0, 0.0)}))


def test_scenes_tell_tensors_and_no_numbers_for_them():
    assert scene().anisotropic
    assert_allclose(scene().tensors, [0.1 * np.eye(3), 5 * np.eye(3), np.diag([1, 2, 3])])
    # Of what is no tensor to the bit: a third of thrice a tenth is not.
    assert scene().mean_conductivities.tolist() == [0.1, 5.0, 2.0]
    with pytest.raises(NotImplementedError, match="Material.conductivity in phase 2 is a tensor: see Scene.tensors"):
        _ = scene().conductivities
    assert "means over directions" in scene()._repr_html_()


def test_numbers_stay_as_they_were():
    plain = Scene((1, 1, 1), Material(0.1), [Layer(0, 0.2, 0.4, Material(3.0))], gradient=(1, 0, 0))
    assert not plain.anisotropic and plain.conductivities.tolist() == plain.mean_conductivities.tolist() == [0.1, 3.0]


def test_turned_scenes_have_turned_tensors():
    order = (2, 0, 1)
    own = Material(orthotropic(1, 2, 3, rotation=TURN))
    body = Scene((1, 2, 3), own, [Layer(1, 0.2, 0.4, own)], walls={"y-": 0.0, "y+": 1.0})
    new = turned(body, order)
    assert new.size == (3, 1, 2) and new.inclusions[0].axis == 2 and set(new.walls) == {"z-", "z+"}
    assert_allclose(new.matrix.tensor, own.tensor[np.ix_(order, order)])
    assert new.inclusions[0].material == new.matrix
    assert turned(turned(new, order), order) == body and turned(body, (0, 1, 2)) is body


def test_no_mirrors_where_a_tensor_may_have_none():
    assert mirrors(scene()) == (None, None, None) and alike_axes(scene()) == (0, 1, 2)
