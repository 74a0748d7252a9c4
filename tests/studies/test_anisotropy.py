"""What the study of tensors compares with what."""

import pandas as pd

from studies import anisotropy


def test_the_finest_elements_are_those_with_most_unknowns():
    rows = [
        {"body": "sphere", "name": name, "unknowns": unknowns, "below_voigt": 0.1, "above_reuss": 0.1}
        | {f"k_{entry}": k * (entry[0] == entry[1]) for entry in anisotropy.ENTRIES}
        for name, unknowns, k in (("fem", 100, 2.0), ("fem", 800, 1.0), ("fft", 64, 3.0), ("fft", 512, 1.01))
    ]
    claims = {sentence: value for sentence, value, _ in anisotropy._sphere(pd.DataFrame(rows))}
    off = next(value for sentence, value in claims.items() if "fft" in sentence)
    assert abs(off - 1.0) < 1e-12
