"""Only here: particles that contacts seem to hold and do not, beside a linear program."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import linprog

from demheat.packing.statistics import contacts_kernels as kernels


def rows_of(matrix):
    """Compressed rows of a bool matrix."""
    return np.concatenate(([0], np.cumsum(matrix.sum(axis=1)))), np.nonzero(matrix)[1].astype(np.uint32)


def directions(rng, number):
    vectors = rng.standard_normal((number, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def balanced(vectors):
    """Whether positive forces along the vectors can be in balance: exactly if no half-space holds all of them."""
    program = linprog(np.zeros(len(vectors)), A_eq=vectors.T, b_eq=np.zeros(3), bounds=(1, None))
    assert program.status in (0, 2)
    return program.status == 0


def held(vectors, half_space=True):
    """Whether vectors hold a particle, through the kernel: particle 0 touches walls only."""
    now, ends = np.empty(1, dtype=bool), np.array([0, len(vectors)])
    none = np.zeros(2, dtype=np.int64), np.empty(0, dtype=np.uint32), np.empty((0, 3))
    contacts = kernels.Contacts(*none, ends, np.array(vectors, dtype=float))
    kernels.held(contacts, half_space, np.ones(1, dtype=bool), now)
    return bool(now[0])


@pytest.mark.twin
def test_unit_vectors():
    rng, box = np.random.default_rng(0), np.array([1.0, 0.0, 2.0])
    centers = rng.random((30, 3)) * [1, 1, 2]
    centers[3] = centers[7]
    indptr, indices = rows_of(~np.eye(30, dtype=bool))
    out = np.empty((len(indices), 3))
    kernels.unit_vectors(centers, box, indptr, indices, out)
    offsets = centers[indices] - np.repeat(centers, 29, axis=0)
    offsets[:, [0, 2]] -= box[[0, 2]] * np.rint(offsets[:, [0, 2]] / box[[0, 2]])
    with np.errstate(invalid="ignore"):
        expected = offsets / np.linalg.norm(offsets, axis=1)[:, None]
    assert np.isnan(expected).all(axis=1).sum() == 2  # the two that coincide, from both sides
    assert_allclose(out, expected, rtol=1e-14, atol=1e-15)  # rounding


@pytest.mark.twin
@pytest.mark.parametrize("half_space", [False, True])
def test_held(half_space):
    """Contacts with particles, some of which are held no more, and with walls."""
    rng, number = np.random.default_rng(1), 40
    indptr, indices = rows_of(rng.random((number, number)) < 0.12)
    wall_indptr = np.concatenate(([0], np.cumsum(rng.integers(0, 3, number))))
    vectors, wall_vectors = directions(rng, len(indices)), directions(rng, wall_indptr[-1])
    before, now = rng.random(number) < 0.8, np.empty(number, dtype=bool)
    kernels.held(kernels.Contacts(indptr, indices, vectors, wall_indptr, wall_vectors), half_space, before, now)
    for i in range(number):
        row, wall = slice(indptr[i], indptr[i + 1]), slice(wall_indptr[i], wall_indptr[i + 1])
        found = np.concatenate((vectors[row][before[indices[row]]], wall_vectors[wall]))
        assert now[i] == (before[i] and len(found) >= 4 and (not half_space or balanced(found)))
    assert 3 < now.sum() < before.sum()


@pytest.mark.twin
def test_what_holds_a_particle():
    tetrahedron = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / np.sqrt(3)
    assert held(tetrahedron) and not held(tetrahedron[:3])
    assert held(tetrahedron, half_space=False) and not held(tetrahedron[:3], half_space=False)
    assert not held(tetrahedron * [[-1], [1], [1], [1]])  # one on the wrong side
    axes = np.vstack((np.eye(3), -np.eye(3)))
    assert held(axes)
    assert not held(axes[:5]) and held(axes[:5], half_space=False)  # closed half-space: nothing at -z
    assert not held(axes[[0, 1, 3, 4]]) and held(axes[[0, 1, 3, 4]], half_space=False)  # in one plane
    assert not held([axes[0], axes[3]] * 3)  # on one line


@pytest.mark.parametrize("seed", range(20))
def test_half_space_rule_is_that_of_a_linear_program(seed):
    rng = np.random.default_rng(seed)
    normals = directions(rng, rng.integers(4, 11))
    assert held(normals) == balanced(normals)
