"""Images: a sphere painted on ever smaller voxels, what the image makes of it and what each method adds.

The simple cubic array, a fifth of spheres of ten times the conductivity, exact by Rayleigh's method, as an image in
which each voxel has the material of its centre. The image has a conductivity of its own, that of its stairs: found by
FFT on the image with each voxel split, its error is the image's and no method's. What a method errs by besides is how
far it is from that.
"""

import numpy as np

from demheat import Image, Scene
from demheat.gallery import simple_cubic
from demheat.referee import value_error
from references.voxels.paint import voxelise
from studies.harness import methods
from studies.harness.pick import order, pick

FRACTION, CONTRAST = 0.2, 10.0
VOXELS = (8, 16, 32, 64)
# Without twins their number is all that is chosen: facets cross the faces of voxels.
PARTICLES = (3_000, 10_000, 30_000, 100_000)
ON_VOXELS = ("fft-plain", "fft-links", "fft-em", "fem-p1")
# Elements are dear beyond this; split voxels altogether.
MOST = {"fem-p1": 32}
FINEST = 128
TIMEOUT = 3600.0


def _cases():
    for n in VOXELS:
        for name in ON_VOXELS:
            if n <= MOST.get(name, n):
                yield methods.case(name, n=n, parts=1)
        for parts in (2, 4, 8):
            if n * parts <= FINEST:
                yield methods.case("fft-plain", n=n, parts=parts)
        for particles in PARTICLES:
            yield methods.case("dem-plain", n=n, parts=1, particles=particles, seed=0)


CASES = list(_cases())
VALUES = True
# Why claims on the stored rows fail.
FAILS = {
    "image of 32^3, DEM without twins, 100000 particles": (
        "the limit was set before; without twins interfaces lie where cells happen to be"
    ),
}


def QUICK(case):
    """Three images, split up to 64 voxels along an edge, and ten thousand particles at most."""
    return case["n"] <= 32 and case["n"] * case["parts"] <= 64 and case.get("particles", 0) <= 10_000


def run(name, n, parts, method, **knobs):
    """Solve the image of the array and compare with the exact value."""
    array = simple_cubic(CONTRAST, fraction=FRACTION)
    phase = voxelise(array, (n, n, n), laminate=False).phase
    for axis in range(3):
        phase = np.repeat(phase, parts, axis)
    image = Image(phase, array.size[0] / (n * parts), dict(enumerate(array.materials)))
    scene = Scene.of_image(image, gradient=array.gradient)
    _, row = methods.solved(scene, methods.exact_ratio(FRACTION, CONTRAST), method=method, **knobs)
    return row | {"volume_percent": 100 * value_error(float(image.fractions[1]), FRACTION)}


def claims(df):
    """The image's own error and its order; what methods add to it.

    Limits were set when values of some methods at 8 to 64 voxels had been seen in a trial, not those of these rows.
    Stairs are of first order; their volume scatters, so that an order of 0.6 is asked for. That of linear elements was
    2.5 % and came down when .6 % was known.
    """
    own = _own(df)
    for n, limit in ((16, 6.0), (32, 3.0), (64, 1.5)):
        yield f"image of {n}^3: its own error, by split voxels, %", _abs(own.get(n)), limit
    for last, limit in ((32, ">= 0.6"), (64, ">= 0.8")):
        known = {n: abs(own[n]) for n in VOXELS if n in own and 16 <= n <= last}
        fitted = order([1 / n for n in known], list(known.values())) if last in known and len(known) > 1 else None
        yield f"image's own error, 16^3 to {last}^3: order in the voxel", fitted, limit
    for name, n, limit in (("fft-plain", 32, 1.0), ("fft-links", 32, 2.5), ("fft-em", 32, 1.0), ("fem-p1", 32, 1.5)):
        text = f"image of {n}^3, {methods.all_methods()[name].title}: distance from the image's own conductivity, %"
        yield text, _abs(_added(df, own, name=name, n=n)), limit
    for n, particles, limit in ((16, 10_000, 2.0), (32, 10_000, 2.0), (32, 100_000, 0.5)):
        text = f"image of {n}^3, DEM without twins, {particles} particles: distance from its own conductivity, %"
        yield text, _abs(_added(df, own, name="dem-plain", n=n, particles=particles)), limit
    text = "image of 16^3, trilinear elements less the image's own conductivity, %: never below it"
    yield text, _added(df, own, name="fem-p1", n=16), "> 0"


def _own(df):
    """Error of each image itself, %: that of its finest split."""
    rows = pick(df, name="fft-plain")
    rows = rows[rows["parts"] > 1].sort_values("parts")
    return {int(n): float(group["error_percent"].iloc[-1]) for n, group in rows.groupby("n")}


def _added(df, own, *, n, **where):
    """How far a method is from the conductivity of the image, % of the exact one; None without either."""
    rows = pick(df, n=n, parts=1, **where)
    return float(rows["error_percent"].iloc[0]) - own[n] if len(rows) and n in own else None


def _abs(value):
    return None if value is None else abs(value)


def table(df):
    """Error of the conductivity, %, against the exact one; `own` is the image's, by split voxels."""
    import pandas as pd

    own, rows = _own(df), []
    for n in sorted(df["n"].unique()):
        mine = pick(df, n=n, parts=1)
        row = {"voxels": f"{n}^3", "volume": float(mine["volume_percent"].iloc[0]), "own": own.get(n, np.nan)}
        for name in ON_VOXELS:
            found = pick(mine, name=name)["error_percent"]
            row[name] = float(found.iloc[0]) if len(found) else np.nan
        for _, each in pick(mine, name="dem-plain").iterrows():
            row[f"dem {each['particles']:.0e}".replace("e+0", "e")] = float(each["error_percent"])
        rows.append(row)
    return pd.DataFrame(rows)


def notes(df):
    """Why one limit is missed, where it is."""
    added = _abs(_added(df, _own(df), name="dem-plain", n=32, particles=100_000))
    if added is not None and added > 0.5:
        yield (
            f"The DEM with 100 000 particles is {added:.2f} % from the image of 32^3, above the limit of .5 % that was "
            "set before: three particles stand in a voxel, and facets cross its faces wherever they fall."
        )


def words(df):
    """How far the DEM and the nearest method on voxels are off the conductivity of the finest image of a known one."""
    own, particles = _own(df), df["particles"].max()
    n = max(own)
    dem = _abs(_added(df, own, name="dem-plain", n=n, particles=particles))
    others = {name: _abs(_added(df, own, name=name, n=n)) for name in ON_VOXELS}
    nearest = min((name for name in others if others[name] is not None), key=others.get)
    return (
        f"with {particles:.0f} particles it is {dem:.2g} % off the conductivity of an image of {n}^3 voxels; "
        f"{methods.all_methods()[nearest].title}, on these voxels is {others[nearest]:.2g} % off"
    )
