"""Beds of grains as networks, one temperature for each, beside what the continuum says of the same grains.

`array`: simple, body- and face-centred cubic arrays of grains that do not quite touch, in a medium, against Rayleigh's
exact values. `contact`: a row of grains that share discs, in a vacuum and in a medium, against elements on the cell of
one grain, a cylinder 1.05 times as wide as the grain (beside one 1.13 times as wide, as large as a grain's part of the
array, some .34 k of the medium more would pass at a contrast of 10). `bed`: spheres at random, hundredths of a diameter
apart at least, against multipoles. Grains have the radius 1, the medium the conductivity 1 (in a vacuum the grains).
All is by the laws of `demheat.grains`, discs of gaps half a radius wide; `wide` is with discs of a whole radius.
"""

from demheat.runtime.lazy import lazy_names
from studies.grains.cases import (
    CONTACTS,
    CONTRASTS,
    FRACTIONS,
    GAPS,
    GOOD,
    KINDS,
    NARROW,
    REALISATIONS,
)
from studies.harness.pick import largest, pick

__getattr__, __dir__ = lazy_names(__name__, {"studies.grains.tables": ("table",), "studies.grains.figure": ("plot",)})

# Limits that are far from the values, and why they are no nearer.
REASONS = {
    "spread of what is missing": "one limit for all arrays, and for quick rows, whose conductivities span less: .12",
}


def _cases():
    for kind in KINDS:
        for gap in GAPS:
            for contrast in CONTRASTS:
                yield {"part": "array", "kind": kind, "gap": gap, "contrast": contrast, "method": "grains"}
    for contact in CONTACTS:
        # Without a contrast there is no medium.
        for contrast in (None, *CONTRASTS):
            yield {"part": "contact", "contact": contact, "contrast": contrast, "method": "grains"}
    for fraction in FRACTIONS:
        for realisation in REALISATIONS:
            for contrast in CONTRASTS:
                here = {"part": "bed", "fraction": fraction, "realisation": realisation, "contrast": contrast}
                yield here | {"method": "grains"}


CASES = list(_cases())
VALUES = True


def QUICK(case):
    """Two arrays at two gaps, two contacts, one bed."""
    if case["part"] == "array":
        return case["kind"] != "bcc" and case["gap"] in (0.03, 0.1)
    if case["part"] == "contact":
        return case["contact"] in (0.05, 0.1) and case["contrast"] in (None, 100.0, 1000.0)
    return case["fraction"] == FRACTIONS[1] and case["realisation"] == 0 and case["contrast"] != GOOD


def run(part, method, **case):
    """Solve grains as a network, and the same as a continuum."""
    from studies.grains import rows

    return {"array": rows.array, "contact": rows.contact, "bed": rows.bed}[part](**case)


def claims(df):
    """What is missing is some of the medium's conductivity; contacts are right to some per cent; where it is poor.

    Limits were set after a first look at a few rows, but for those of the beds.
    """
    arrays = pick(df, part="array")
    yield from _array_claims(arrays[arrays["contrast"] >= GOOD])
    poor = arrays[(arrays["contrast"] == CONTRASTS[0]) & (arrays["gap"] >= NARROW)]
    least = poor["error_percent"].abs().min() if len(poor) else None
    yield "arrays, contrast 10, gaps of 0.03 and more: least error, %", least, ">= 15"
    yield from _contact_claims(pick(df, part="contact"))
    yield from _bed_claims(pick(df, part="bed"))


def _array_claims(rows):
    """Near grains that conduct well: the law knows gap and contrast, and not what passes elsewhere."""
    near = rows[rows["gap"] <= NARROW]
    for kind, group in near.groupby("kind", sort=False):
        spread, span = (float(group[name].max() - group[name].min()) for name in ("missing", "exact_ratio"))
        text = f"{kind}, contrasts from 100, gaps to 0.03: spread of what is missing over that of the conductivity"
        yield text, spread / span if span > 0 else None, 0.15
    text = "arrays, contrasts from 100, gaps to 0.03: most that is missing, k of the medium"
    yield text, largest(near, "missing"), 3.0


def _contact_claims(rows):
    bare = pick(rows, contrast=None)
    small = bare[bare["contact"] <= 0.05]
    yield "contacts in a vacuum, to 0.05 radii: worst error, %", largest(small, "error_percent"), 6.0
    yield "contacts in a vacuum: worst error, %", largest(bare, "error_percent"), 11.0
    yield "contacts, contrast 1000: worst error, %", largest(pick(rows, contrast=1000.0), "error_percent"), 16.0


def _bed_claims(rows):
    """Nearly touching spheres at random: of the same sign and size as in arrays."""
    good = rows[rows["contrast"] >= GOOD]
    yield "beds, contrasts from 100: most that is missing, k of the medium", largest(good, "missing"), 3.0
