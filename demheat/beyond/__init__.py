"""Past one process: ranks of MPI, what PETSc solves on them, and workers of Dask."""
