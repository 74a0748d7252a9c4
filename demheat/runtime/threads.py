"""One place that chooses how compiled loops use threads, and lets several Python threads compute at once.

Numba's workqueue layer is always present and lets its threads sleep between loops; OpenMP's spin, which costs whole
time slices on a shared machine, and processes forked after it has run are killed. Set NUMBA_THREADING_LAYER to choose
another, NUMBA_NUM_THREADS=1 for one thread.

The workqueue layer ends the process if a second Python thread enters a parallel loop while one runs, and hands even a
loop of one thread over to another, which takes some 40 microseconds. So all parallel loops pass through a gate here,
one at a time, for less than 0.2 microseconds each; they take microseconds to tenths of a second, and Python threads
take turns. A loop of one thread needs no other: the calling thread runs it itself, beside all others. Loops compiled
before this module is imported do not know the gate.
"""

import ctypes
import os
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from functools import cache

import llvmlite.binding as llvm
import numba
from llvmlite import ir

if "NUMBA_THREADING_LAYER" not in os.environ:
    numba.config.THREADING_LAYER = "workqueue"

# Compiled loops look the entry of the threading layer up by this name when they are compiled or loaded.
ENTRY = "numba_parallel_for"
# Pointers and counts that it takes: first the loop's function and its four arguments, last the number of threads.
ARGUMENTS, OF_LOOP = 8, slice(1, 5)
_kept = []


def _take_turns():
    """Put a gate before the entry of the workqueue layer, for all that is compiled or loaded from now on."""
    from numba.np.ufunc import workqueue

    python = ctypes.pythonapi
    python.PyThread_allocate_lock.restype = ctypes.c_void_p
    lock = python.PyThread_allocate_lock()
    wait, leave = (_address(each) for each in (python.PyThread_acquire_lock, python.PyThread_release_lock))
    module = _gate(lock, {"demheat_wait": wait, "demheat_leave": leave, "demheat_enter": workqueue.parallel_for})
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=2)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(str(module)), machine)
    engine.finalize_object()
    _kept.append(engine)
    llvm.add_symbol(ENTRY, engine.get_function_address("demheat_gate"))
    if hasattr(os, "register_at_fork"):
        # A child gets the lock as it is: fork between loops only, and open it on both sides. Called by their addresses
        # these functions let Python's other threads run meanwhile.
        close = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int)(wait)
        reopen = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(leave)
        after = {side: lambda: reopen(lock) for side in ("after_in_parent", "after_in_child")}
        os.register_at_fork(before=lambda: close(lock, 1), **after)


def _address(function):
    return ctypes.cast(function, ctypes.c_void_p).value


def _gate(lock, functions):
    """The gate as LLVM's code: Python's own lock, which its callers have released, is not needed for any of it."""
    for name, address in functions.items():
        llvm.add_symbol(name, address)
    word, void, integer = ir.IntType(8 * ctypes.sizeof(ctypes.c_void_p)), ir.VoidType(), ir.IntType(32)
    module = ir.Module()
    wait, leave, enter = (
        ir.Function(module, ir.FunctionType(result, takes), name)
        for name, result, takes in zip(
            functions, (integer, void, void), ([word, integer], [word], [word] * ARGUMENTS), strict=True
        )
    )
    gate = ir.Function(module, ir.FunctionType(void, [word] * ARGUMENTS), "demheat_gate")
    code = ir.IRBuilder(gate.append_basic_block())
    with code.if_else(code.icmp_signed("==", gate.args[-1], word(1))) as (alone, together):
        with alone:
            loop = code.inttoptr(gate.args[0], ir.FunctionType(void, [word] * 4).as_pointer())
            code.call(loop, gate.args[OF_LOOP])
        with together:
            code.call(wait, [word(lock), integer(1)])
            code.call(enter, gate.args)
            code.call(leave, [word(lock)])
    code.ret_void()
    return module


def shared_out(work, count: int, *arguments, piece: int) -> None:
    """Do work(first, last, *arguments) over a count in pieces, by as many threads as compiled loops use.

    For compiled functions that let go of Python's lock and have no parallel loop of their own, which would take three
    times as long to compile. Pieces of unlike length even out: whoever is done takes the next, the calling thread as
    well, and what is no more than a piece needs no other. After an exception no further piece is begun.
    """
    if count <= piece:
        work(0, count, *arguments)
        return
    pieces = iter(range(0, count, piece))

    def some():
        try:
            for first in pieces:
                work(first, min(count, first + piece), *arguments)
        finally:
            for _ in pieces:  # left by one that failed
                pass

    others = min(numba.get_num_threads(), -(-count // piece)) - 1
    futures = [_others().submit(some) for _ in range(others)]
    try:
        some()
    finally:
        # One that has not begun need not, and may wait for another's work.
        futures = [future for future in futures if not future.cancel()]
        wait(futures)
    for future in futures:
        future.result()


@cache
def _others():
    """Threads beside the calling one: made once, as they take longer to begin than many a piece."""
    return ThreadPoolExecutor(max(1, numba.config.NUMBA_NUM_THREADS - 1))


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_others.cache_clear)  # threads are not copied


@contextmanager
def thread_limit(threads: int | None):
    """Let compiled loops use so many threads for a while."""
    before = numba.get_num_threads()
    numba.set_num_threads(before if threads is None else min(threads, numba.config.NUMBA_NUM_THREADS))
    try:
        yield
    finally:
        numba.set_num_threads(before)


if not numba.config.DISABLE_JIT:
    numba.get_num_threads()  # starts the layer, which names its entry
    if numba.threading_layer() == "workqueue":
        _take_turns()
