"""Only here: BLAS left with one thread, or NumPy's generator moved, after who asked for it."""

import threading

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

from demheat.runtime.process_state import _counts_by_thread, _libraries, _set_all, one_blas_thread, seeded


def test_seeded_is_the_same_each_time_and_leaves_no_trace():
    before, found = np.random.get_state()[1].copy(), []  # noqa: NPY002
    for _ in range(2):
        with seeded():
            found.append(np.random.rand())  # noqa: NPY002
        np.testing.assert_array_equal(np.random.get_state()[1], before)  # noqa: NPY002
    assert found[0] == found[1]


def counts():
    return [each["num_threads"] for each in _libraries().info()]


@pytest.fixture
def two():
    """BLAS with two threads, if it has more than one; numbers of before."""
    blas = _libraries()
    before = blas.info()
    _set_all(blas, [each | {"num_threads": 2} for each in before])
    if 2 not in counts():
        pytest.skip("BLAS has one thread here")
    yield counts()
    _set_all(blas, before)


def test_the_last_thread_out_puts_back_what_the_first_one_found(two):
    inside, out = threading.Event(), threading.Event()

    def other():
        with one_blas_thread():
            inside.set()
            out.wait(10)

    thread = threading.Thread(target=other)
    with one_blas_thread():
        thread.start()
        assert inside.wait(10) and set(counts()) == {1}
    out.set()
    thread.join()
    assert counts() == two


@pytest.mark.skipif(_counts_by_thread(), reason="this BLAS counts by thread")
def test_who_leaves_first_gives_the_others_no_threads(two):
    """Sums in another thread's product would change their order in the midst of it."""
    inside, out, left = threading.Event(), threading.Event(), threading.Event()

    def other():
        with one_blas_thread():
            inside.set()
            out.wait(10)
        left.set()

    thread = threading.Thread(target=other)
    thread.start()
    # The other has come first, and leaves first.
    assert inside.wait(10)
    with one_blas_thread():
        out.set()
        assert left.wait(10) and set(counts()) == {1}
    thread.join()
    assert counts() == two


@pytest.mark.skipif(_counts_by_thread(), reason="this BLAS counts by thread")
def test_any_thread_may_ask(two):
    """threadpoolctl obeys one thread at a time: not the first that ever asked."""
    found = []

    def other():
        with one_blas_thread():
            found.append(counts())

    with one_blas_thread():
        pass
    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert set(found[0]) == {1} and counts() == two


def test_a_caller_who_has_asked_before_is_obeyed(two):
    with threadpool_limits(2, "blas"):
        with one_blas_thread():
            assert set(counts()) == {1}
        assert counts() == two
