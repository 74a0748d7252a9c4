"""Sweeps: one function over many cases, here or on a cluster, with one row for each."""

from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import Any

from demheat.runtime.rows import each_kept
from demheat.scene.inputs import finite
from demheat.sweeps.cases import case_list
from demheat.sweeps.file import opened
from demheat.sweeps.rows import row_of
from demheat.sweeps.workers import on_workers

__all__ = ["sweep"]


def sweep(
    function: Callable[..., object],
    cases: Mapping[str, Any] | Iterable[Mapping[str, Any]],
    *,
    client: object | None = None,
    out: str | PathLike[str] | None = None,
    timeout: float | None = None,
) -> list[dict[str, Any]]:
    """Call a function for each of many cases; a case that fails is a row with its error, not the end.

    Without a client cases are computed one after another in this process, and the first pays for what is loaded and
    compiled on first use. With one each is computed in a fresh process of some worker, so that its cost is its own and
    a crash is an error like others; workers may die or join meanwhile.

    Parameters
    ----------
    function : callable (keywords of a case) -> number, text, dict, Field or Effective
        A dict holds numbers and text. Of a Field the row has `conductivity`, W/(m K), `unknowns`, `iterations` and
        `residual`; of what `effective` returns `k_xx` to `k_xy`, W/(m K), `accuracy` and `method`.
    cases : dict of lists, or list of dicts
        Lists of values, of which every combination is a case, the last name fastest; or the cases themselves.
    client : distributed.Client, optional
        Of a Dask cluster (``pip install 'demheat[distributed]'``), whose workers have demheat and what the function
        imports.
    out : path, optional
        CSV file to which each row is added as it is done. A case that stands there without an error is not computed
        again, *whatever the function was then*: another function needs another file. Values of cases must be plain
        then, so that a row can be found again. Several sweeps may write one file: each begins with the rows it finds.
    timeout : float, s, optional
        Of each case; needs a client.

    Returns
    -------
    list of dict
        In the order of the cases: the case, what the function returned (a number or text as `value`), `error` (empty if
        there is none), `wall_s` and `cpu_s`, s, `when`, `machine`, `host` and `version`. Seconds of different hosts
        cannot be compared. ``pandas.DataFrame`` takes it as it is.

    Raises
    ------
    ValueError
        If an argument is none of these, or the file cannot be read or written.
    OSError
        If the scheduler is gone; what is done is in the file.

    Examples
    --------
    >>> from demheat import Field, gallery, solve, sweep
    >>> def conductivity(contrast: float, particles: int) -> Field:
    ...     return solve(gallery.sphere_in_cube(contrast), particles=particles)
    >>> rows = sweep(conductivity, {"contrast": [2.0, 5.0, -1.0], "particles": [1000]})
    >>> [round(row["conductivity"], 1) for row in rows if not row["error"]]
    [37.0, 42.7]
    >>> rows[2]["error"]
    'ValueError: contrast = -1.0: must be ...
    """
    if not callable(function):
        raise ValueError(f"function = {function!r}: must be a function of the values of a case")
    cases = case_list(cases, plain=out is not None)
    if client is not None and not all(callable(getattr(client, name, None)) for name in ("submit", "run")):
        raise ValueError(f"client = {client!r}: must be a distributed.Client")
    if timeout is not None:
        timeout = finite("timeout", timeout, "seconds above 0", lambda v: v > 0)
        if client is None:
            raise ValueError(f"timeout = {timeout!r}: must be None without a client; this process cannot end itself")
    file = None if out is None else opened(out)
    todo = [number for number, case in enumerate(cases) if file is None or not file.has(case)]
    asked = [cases[number] for number in todo]
    here = enumerate(row_of(function, case) for case in asked)
    arriving = here if client is None else on_workers(client, function, asked, timeout)
    made = {}

    def keep(number, row):
        made[number] = row
        if file is not None:
            file.add(cases[number], row)

    for _ in each_kept(todo, arriving, keep, what="sweep"):
        pass
    return [made[number] if file is None else file.row(case) for number, case in enumerate(cases)]
