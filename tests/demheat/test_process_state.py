import threading

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from demheat.process_state import one_blas_thread, seeded


def test_seeded_is_the_same_each_time_and_leaves_no_trace():
    before, found = np.random.get_state()[1].copy(), []  # noqa: NPY002
    for _ in range(2):
        with seeded():
            found.append(np.random.rand())  # noqa: NPY002
        np.testing.assert_array_equal(np.random.get_state()[1], before)  # noqa: NPY002
    assert found[0] == found[1]


def counts():
    return [each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"]


def test_the_last_thread_out_puts_back_what_the_first_one_found():
    inside, out = threading.Event(), threading.Event()

    def other():
        with one_blas_thread():
            inside.set()
            out.wait(10)

    with threadpool_limits(2, "blas"):
        before, thread = counts(), threading.Thread(target=other)
        with one_blas_thread():
            thread.start()
            assert inside.wait(10) and set(counts()) == {1}
        out.set()
        thread.join()
        assert counts() == before and 2 in before
