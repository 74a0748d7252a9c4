"""What stands below the table of the sphere's centre: the network's variants, and the stall of quadratic elements."""

from studies.common.paper_variants import parted, shown, told_of
from studies.fig07_sphere.means import PAPER, TIGHTER, network_errors, plain
from studies.harness.pick import pick


def notes(df):
    """The paper's network in all its variants, and where quadratic elements stall."""
    network, others = parted(df)
    made, among = network_errors(network), ["error_10s"]
    names = {"error_10s": "at 10 s, K", "worst": "largest, K"}
    what = "in all its variants: error of the centre at 10 s (signed) and the largest in time, K"
    said = shown(made, names, what, "; the best has the least at 10 s", among)
    if made:
        said.append(told_of(made, among, unit="K") + f" The paper prints {PAPER['centre_10s']:g} K with 1e5.")
    return said + list(_stall(others))


def _stall(df):
    """By how much a tenth of the temporal error moves the centre, beside its error."""
    for size, accuracy in TIGHTER.items():
        usual, tight = pick(plain(df), order=2, size=size), pick(df, order=2, size=size, accuracy=accuracy)
        tight = tight[tight["status"] == "ok"]
        if not len(usual) or not len(tight):
            continue
        before, after = (float(rows["error_10s"].iloc[0]) for rows in (usual, tight))
        yield (
            f"Quadratic elements of {1000 * size:g} mm are {before:+.4f} K off at 10 s, and with a tenth of the "
            f"temporal error per step {after:+.4f} K, {after - before:+.4f} K from there: "
            f"{'most' if abs(after) < abs(before) / 2 else 'little'} of it is temporal."
        )
