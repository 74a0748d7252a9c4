"""Walkers as a referee: which of their rows judges a scene, and whether a method's value lies in their interval."""

from demheat import referee
from studies.formless.parts import BAD, BOARDS, GOOD, LABYRINTHS
from studies.harness.pick import pick

# Who judge and are not judged.
WITNESSES = ("walkers", "bracket")
# Right is what lies in the interval that holds the truth 95 times of 100, or as near as this, %.
NEAR = 2.0
TITLES = {"fem": "FEM", "fem-p1": "FEM", "dem": "DEM", "fft": "FFT", "fft-plain": "FFT", "fft-links": "FFT"}


def witness(df, part, contrast, fraction):
    """What walkers found over the matrix's conductivity, and half of their interval, %; None where they did not walk.

    Both labyrinths of a surface are alike: of a good one that is a hundred times what they found of the bad one that is
    the rest of the cell.
    """
    walkers, scale = pick(df, name="walkers", part=part), 1.0
    if part in LABYRINTHS and contrast == GOOD:
        contrast, fraction, scale = BAD, 1 - fraction, GOOD
    walkers = walkers[walkers["contrast"] == contrast]
    if fraction == fraction and fraction is not None:
        walkers = walkers[(walkers["fraction"] - fraction).abs() < 1e-9]
    if not len(walkers):
        return None
    return scale * float(walkers["walked_ratio"].iloc[0]), float(walkers["walked_half_percent"].iloc[0])


def judged(df):
    """Rows of methods, the finest elements of each scene alone, where walkers have walked.

    With how far they are off walkers, %, the same in halves of their interval, and what that is.
    """
    lines = []
    for (part, contrast, fraction), group in df.groupby(["part", "contrast", "fraction"], sort=False, dropna=False):
        known = witness(df, part, contrast, fraction)
        own = finest(group)
        for row in own.to_dict("records") if known else ():
            off = 100 * referee.value_error(row["k_ratio"], known[0])
            lines.append(row | {"off_percent": off, "off_halves": off / known[1], "half_percent": known[1]})
    columns = ("off_percent", "off_halves", "half_percent")
    return df.iloc[:0].assign(**{name: [] for name in columns}) if not lines else type(df)(lines)


def finest(group):
    """Rows of methods that a scene has, of elements the finest alone."""
    own = group[~group["name"].isin(WITNESSES)]
    return own[~(own["size"] > own["size"].min())]


def wrong(rows):
    """Those of judged rows that lie neither in the interval nor near."""
    off = rows["off_percent"].abs()
    return rows[~((off <= rows["half_percent"]) | (off <= NEAR))]


def outside(rows):
    """Those of judged rows that do not lie in the interval."""
    return rows[~(rows["off_halves"].abs() <= 1.0)]


def certain(df, row):
    """Bounds that hold for sure: of a checkerboard those of two admissible fields, else those of the fractions."""
    if row["part"] in BOARDS:
        bracket = pick(df, name="bracket", part=row["part"], contrast=row["contrast"])
        if len(bracket):
            return float(bracket["lower_ratio"].iloc[0]), float(bracket["upper_ratio"].iloc[0])
    return row["lower_ratio"], row["upper_ratio"]


def beyond(df, row):
    """How far a value lies outside of its bounds, % of the one it passes; 0 between them, not-a-number of none."""
    low, high = certain(df, row)
    below, above = low - row["k_ratio"], row["k_ratio"] - high
    if not (below <= 0 or above <= 0):
        return float("nan")
    return 100 * max(below / low if below > 0 else 0.0, above / high if above > 0 else 0.0)


def named(rows, all_of):
    """Which methods' values do not lie there, in words; nothing where none was asked."""
    if not len(all_of):
        return ""
    return ", ".join(dict.fromkeys(TITLES[name] for name in rows["name"])) or "none"


def words(df):
    """How many scenes walkers judge, how sharply, and which values of each method their intervals hold."""
    rows, own = judged(df), pick(df, name="walkers")
    halves, parts = own["walked_half_percent"], []
    for title in ("FEM", "DEM", "FFT"):
        mine = rows[rows["name"].map(TITLES) == title]
        if len(mine):
            parts.append(f"of {title} they hold {len(mine) - len(outside(mine))} of {len(mine)}{_rest(mine)}")
    count = len(rows.drop_duplicates(["part", "contrast", "fraction"]))
    return (
        f"walkers, who have no grid, judge {count} scenes by intervals (95 %) of {halves.min():.2g} to "
        f"{halves.max():.2g} % on either side: {'; '.join(parts)}"
    )


def _rest(rows):
    rest = outside(rows)["off_percent"].abs()
    if not len(rest):
        return ""
    ends = dict.fromkeys(f"{end:.2g}" for end in (rest.min(), rest.max()))
    return f" (others are {' to '.join(ends)} % off)"
