"""One place that chooses how compiled loops use threads, and lets several Python threads compute at once.

Numba's workqueue layer is always present and lets its threads sleep between loops; OpenMP's spin, which costs whole
time slices on a shared machine, and processes forked after it has run are killed. Set NUMBA_THREADING_LAYER to choose
another, NUMBA_NUM_THREADS=1 for one thread.

The workqueue layer ends the process if a second Python thread enters a parallel loop while one runs. So all parallel
loops pass through a gate here, one at a time: about 20 ns each. They take microseconds to tenths of a second, so the
threads take turns. Loops compiled before this module is imported do not know the gate.
"""

import ctypes
import os

import llvmlite.binding as llvm
import numba

if "NUMBA_THREADING_LAYER" not in os.environ:
    numba.config.THREADING_LAYER = "workqueue"

# Compiled loops look the entry of the threading layer up by this name, when they are compiled or loaded.
ENTRY = "numba_parallel_for"
# What it takes, pointers and counts, and hands on while it holds a lock of Python's. Python's own lock is free then:
# the wait stops no other thread. Integers stand for pointers, which older and newer LLVM spell differently.
ARGUMENTS = 8
_GATE = """
declare i32 @demheat_acquire({word}, i32)
declare void @demheat_release({word})
declare void @demheat_parallel_for({types})
define void @demheat_gate({named}) {{
  %done = call i32 @demheat_acquire({word} {lock}, i32 1)
  call void @demheat_parallel_for({named})
  call void @demheat_release({word} {lock})
  ret void
}}
"""
_kept = []


def _take_turns():
    """Put a lock before the entry of the workqueue layer, for all that is compiled or loaded from now on."""
    from numba.np.ufunc import workqueue

    python = ctypes.pythonapi
    python.PyThread_allocate_lock.restype = ctypes.c_void_p
    lock, word = python.PyThread_allocate_lock(), f"i{8 * ctypes.sizeof(ctypes.c_void_p)}"
    acquire, release = (
        ctypes.cast(f, ctypes.c_void_p).value for f in (python.PyThread_acquire_lock, python.PyThread_release_lock)
    )
    for name, address in (("acquire", acquire), ("release", release), ("parallel_for", workqueue.parallel_for)):
        llvm.add_symbol(f"demheat_{name}", address)
    text = _GATE.format(
        word=word,
        lock=lock,
        types=", ".join([word] * ARGUMENTS),
        named=", ".join(f"{word} %a{i}" for i in range(ARGUMENTS)),
    )
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(text), machine)
    engine.finalize_object()
    llvm.add_symbol(ENTRY, engine.get_function_address("demheat_gate"))
    # A child gets the lock as it is: fork only between loops, and open it again on both sides. Foreign functions
    # called by address let Python's other threads run meanwhile.
    wait = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int)(acquire)
    leave = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(release)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(
            before=lambda: wait(lock, 1),
            after_in_parent=lambda: leave(lock),
            after_in_child=lambda: leave(lock),
        )
    _kept.append(engine)


if not numba.config.DISABLE_JIT:
    numba.get_num_threads()  # starts the layer, which names its entry
    if numba.threading_layer() == "workqueue":
        _take_turns()
