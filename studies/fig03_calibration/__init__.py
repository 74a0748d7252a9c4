"""C_t against the number of particles: how the contact network of the paper is calibrated, and why C_t drifts.

C_t = lambda / lambda_e of a homogeneous sample with C_t = 1 (Haddad et al., Int. J. Thermal Sciences 164, 2021, 106799,
eqs. 7-9, and its figure 3). Loads along y: "flux" is the paper's, a flux on top, a temperature below, the difference
read at the top in the centres of the particles there, the sides insulated, 7.5 links on average over the whole sample
between walls; "isothermal" has two temperatures instead. "across" has walls along the load only, is periodic across,
counts links in the bulk and puts imposed temperatures at the wall; "periodic" has no walls. Packings: "lsa" is hard
spheres grown to a reduced pressure of 120, "relaxed" is overlapping spheres pushed apart, at the same packing fraction
of the bulk; "replicated" repeats a relaxed periodic one.
"""

from demheat import referee
from demheat.runtime.lazy import lazy_names
from studies.fig03_calibration.variants import PAPER, PRINTED, VARIANTS, VARIED, unchanged, variant
from studies.harness.pick import pick

__getattr__, __dir__ = lazy_names(
    __name__, {"studies.fig03_calibration.tables": ("table",), "studies.fig03_calibration.figure": ("plot",)}
)

SEEDS = (0, 1, 2, 3)
# Packings of a mean; all where the paper prints their scatter, of four.
FEW = 3
NUMBERS = {"relaxed": (1_000, 3_000, 10_000, 100_000), "lsa": (3_000, 10_000, 100_000)}
LOADS = (("flux", "cube"), ("isothermal", "cube"), ("across", "cube"), ("periodic", "cube"), ("flux", "cylinder"))
CUBE, DRUM = LOADS[0], LOADS[-1]
# From the paper's way to the periodic cell, one cure at a time.
CURES = (
    ("isothermal", {"margin": 4.0}),
    ("isothermal", {"margin": 4.0, "wall": "surface"}),
    ("across", {"wall": "center"}),
)
POLICIES = ({"sparse": "keep"}, {"sparse": "drop"}, {"sparse": "drop", "count": "rest"})
# Limits from elsewhere: a bound, and what the paper prints of its packings.
ELSEWHERE = ("affine bound", "lsa packings, as in the paper")
TIMEOUT = 3600.0
# Range of C_t in the periodic cell, %.
RANGES = {"relaxed": 1.0, "lsa": 0.2}
# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "dropped or kept": "the same equations but for some that nothing flows into, solved to 1e-10 of the heat",
    "lsa packings, periodic cell": "means of three packings, each of which scatters by .2 % at 1e5 and more below",
    "of one replica": "a field that repeats, solved to 1e-10 of the heat",
}
# Why claims on the stored rows fail.
FAILS = {
    "lsa packings, periodic cell, 3000 particles and more: range": (
        "C_t of 3000 particles is not quite that of 100 000: the limit is missed by a hundredth of it"
    ),
    "C_t off the printed 0.806": (
        "no packing, load or calibration gives it with the printed spread of radii; ct_search asks which other set "
        "would"
    ),
}


def _case(loading, packing, particles, seed, domain="cube", **more):
    here = {"loading": loading, "domain": domain, "packing": packing, "particles": particles, "seed": seed}
    return here | more | {"method": "dem"}


def _seeds(packing, number, load):
    """Of which packings; isothermal ends are shown beside the paper's load only.

    Of 1e5 hard spheres, two minutes each, none in a drum or with walls along the load alone.
    """
    dear = (packing, number) == ("lsa", VARIED)
    if dear and (load == DRUM or load[0] == "across"):
        return ()
    if load[0] == "isothermal" or (number == VARIED and (load == DRUM or load[0] == "across")):
        return SEEDS[:1]
    return SEEDS if (number, load) == (VARIED, CUBE) else SEEDS[:FEW]


def _cases():
    for packing, numbers in NUMBERS.items():
        for number in numbers:
            for load in LOADS:
                yield from (_case(load[0], packing, number, seed, load[1]) for seed in _seeds(packing, number, load))
    for loading in ("flux", "periodic"):
        for change in list(VARIANTS.values())[1:]:
            # Other spreads ask for packings of their own.
            if loading == "flux" or "spread" not in change:
                yield _case(loading, "lsa", VARIED, 0, **change)
    for loading, cure in CURES:
        numbers = (10_000, VARIED) if loading != "across" else (10_000,)
        yield from (_case(loading, "lsa", number, 0, **cure) for number in numbers)
    for change in POLICIES:
        yield _case("periodic", "relaxed", 3_000, 0, **change)
        yield from (_case("periodic", "lsa", 10_000, seed, **change) for seed in SEEDS[:FEW])
    yield _case("flux", "lsa", 10_000, 0, sparse="drop")
    yield _case("periodic", "relaxed", 80_000, 0)
    yield _case("periodic", "replicated", 80_000, 0, replicas=2)


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """One relaxed packing of 3000 for each load that the claims compare, and a smaller one for the drift."""
    small = case["packing"] == "relaxed" and case["seed"] == 0 and case.get("count") is None
    if not small or case["particles"] > 3_000 or case["loading"] == "isothermal" or case.get("sparse") == "keep":
        return False
    return case["particles"] == 3_000 or (case["loading"], case["domain"]) == ("flux", "cube")


def run(loading, domain, packing, particles, seed, method, *, spread=0.3, replicas=1, **knobs):
    """C_t of one packing under one load."""
    from studies.fig03_calibration.rows import calibrated, packed

    sample = packed(loading, domain, packing, particles, seed, spread=spread, replicas=replicas)
    return calibrated(sample, loading, **knobs)


def claims(df):
    """C_t does not drift without walls or with links at them; with the paper's walls it does.

    Where walls do not matter C_t is held to 1 % from 3000 particles on and 0.3 % from 1e5; with the paper's walls the
    printed scatter is the yardstick, and 0.806 at 1e5, to three times that: it is not reproduced. Of LSA packings in
    the periodic cell the range was held to 1 % before it was known, differences that are rounding to 1e-6, and C_t of
    replicas to 1 %.
    """
    plain = df[unchanged(df)]
    yield from [*_wall_claims(plain), *_paper_claims(plain), *_level_claims(df), *_other_claims(df, plain)]


def _means(rows, **where):
    """Mean C_t over packings by number of particles."""
    return pick(rows, **where).groupby("particles")["ct"].agg(lambda ct: ct.mean(skipna=False))


def _wall_claims(plain):
    for packing in ("relaxed", "lsa"):
        walls, cell = (_means(plain, packing=packing, loading=loading) for loading in ("across", "periodic"))
        off = (100 * referee.value_error(walls, cell).abs()).dropna()
        for least, most, limit in ((3_000, 30_000, 1.0), (100_000, 1e9, 0.3)):
            text = f"{packing} packings, walls along the load, {least} particles and more"
            here = off[(off.index >= least) & (off.index <= most)]
            yield f"{text}: C_t off that of the periodic cell, %", here.max() if len(here) else None, limit
        cell = cell[cell.index >= 3_000]
        drift = 100 * referee.value_error(cell.max(), cell.min()) if len(cell) > 1 else None
        yield f"{packing} packings, periodic cell, 3000 particles and more: range of C_t, %", drift, RANGES[packing]


def _paper_claims(plain):
    for packing in ("relaxed", "lsa"):
        cube, drum = (_means(plain, packing=packing, loading="flux", domain=d) for d in ("cube", "cylinder"))
        text = f"{packing} packings, as in the paper: least rise of C_t from one number to the next"
        yield text, cube.diff().min() if len(cube) > 1 else None, "> 0"
        alike = (100 * referee.value_error(drum, cube).abs()).dropna()
        alike = alike[alike.index >= 3_000]
        text = f"{packing} packings, as in the paper: cylinder against cube from 3000 particles, %"
        # At equal number a cylinder is 8 % wider: its walls, which take 8 % off C_t at 1e4, take 0.6 % less.
        yield text, alike.max() if len(alike) else None, 1.5
        rows = pick(plain, packing=packing, loading="flux", domain="cube", particles=VARIED)
        cov = 100 * rows["ct"].std() / rows["ct"].mean() if len(rows) == len(SEEDS) else None
        yield (
            f"{packing} packings, as in the paper, 1e5 particles: scatter over {len(SEEDS)} packings, %",
            cov,
            PAPER["cov"],
        )


def _level_claims(df):
    """C_t at 1e5 as in the paper beside the printed one."""
    ct, there = variant(df, "flux", VARIANTS["as in the paper"]), PRINTED[VARIED]
    off = None if ct is None else 100 * abs(referee.value_error(ct, there))
    yield f"1e5 particles, as in the paper: C_t off the printed {there:g}, %", off, 3 * PAPER["cov"]


def _other_claims(df, plain):
    cell = pick(df, loading="periodic")
    yield "Periodic cell: least C_t over its affine bound", (cell["ct"] / cell["bound"]).min(), ">= 1"
    joined, kept, dropped = (_by_packing(rows) for rows in (plain, pick(df, sparse="keep"), pick(df, sparse="drop")))
    if len(kept):
        yield "Poorly linked particles dropped or kept: difference of C_t", _differ(kept, dropped), 1e-10
    text = "Poorly linked particles dropped or joined to the nearest: difference of C_t, %"
    yield text, 100 * _differ(joined, dropped), 0.5
    replicas, one, true = (
        pick(df, loading="periodic", packing=packing, particles=number, seed=0)["ct"].to_numpy()
        for packing, number in (("replicated", 80_000), ("relaxed", 10_000), ("relaxed", 80_000))
    )
    if len(replicas) == len(one) == len(true) == 1:
        text = "Periodic cell of 8 replicas of 1e4: C_t off that of"
        yield f"{text} one replica", abs(referee.value_error(replicas, one))[0], 1e-10
        yield f"{text} a packing of 8e4, %", 100 * abs(referee.value_error(replicas, true))[0], 0.5


def _by_packing(rows):
    """C_t of periodic rows by packing."""
    return pick(rows, loading="periodic", count=None).set_index(["packing", "particles", "seed"])["ct"]


def _differ(one, other):
    """Largest relative difference of what is in both."""
    return float(referee.value_error(one, other).abs().max())


def notes(df):
    """What C_t is at 1e5 with one thing changed, as it is not the printed one."""
    ct = {name: variant(df, "flux", change) for name, change in VARIANTS.items()}
    found = ", ".join(f"{name} {value:.3f}" for name, value in ct.items() if value is not None)
    if found:
        yield (
            f"C_t of {PRINTED[VARIED]:g} with 1e5 particles is not reproduced; what differs is not known. One LSA "
            f"packing each, changed in one thing: {found}."
        )
