"""Ranks of an MPI run as threads of this process, with as much of a communicator as is used besides libraries."""

import threading
from concurrent.futures import ThreadPoolExecutor


class Comm:
    """What mpi4py's communicator does, between threads."""

    def __init__(self, rank, size, barrier, board):
        self.rank, self.size, self._barrier, self._board = rank, size, barrier, board

    def Barrier(self):  # noqa: N802, as mpi4py has it
        self._barrier.wait(60)

    def allgather(self, value):
        self._board[self.rank] = value
        self.Barrier()
        found = [self._board[rank] for rank in range(self.size)]
        self.Barrier()
        return found

    def allreduce(self, value):
        return sum(self.allgather(value))

    def scan(self, value):
        return sum(self.allgather(value)[: self.rank + 1])

    def bcast(self, value, root):
        return self.allgather(value)[root]

    def alltoall(self, values):
        return [row[self.rank] for row in self.allgather(values)]

    def Sendrecv(self, sent, dest, recvbuf, source):  # noqa: N802, as mpi4py has it
        found = self.allgather((dest, sent.copy()))[source]
        assert found[0] == self.rank
        recvbuf[...] = found[1]


def on_ranks(number, work):
    """What a function of a communicator returns on each of some ranks."""
    barrier, board = threading.Barrier(number), {}

    def run(rank):
        try:
            return work(Comm(rank, number, barrier, board))
        except BaseException:
            barrier.abort()
            raise

    with ThreadPoolExecutor(number) as pool:
        return list(pool.map(run, range(number)))
