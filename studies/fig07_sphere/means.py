"""What is printed and shown of the sphere's centre, and the errors of the network's variants."""

from studies.common import sphere_in_time
from studies.common.paper_network import WALLED
from studies.common.paper_variants import interval, variants
from studies.common.sphere_in_time import ACCURACY, SIZES
from studies.harness.pick import pick
from studies.harness.printed import printed

PAPER = printed("fig07_sphere")
# Sizes of quadratic elements that are marched with a tenth of the temporal error.
TIGHTER = {SIZES[2][0]: ACCURACY["fem"] / 10}


def plain(df):
    """Rows with numbers and their names, without those of tighter marches."""
    return sphere_in_time.solved(pick(df, accuracy=None))


def network_errors(network):
    """Errors of the centre of the network's variants, K: at 10 s (signed) and the largest, with intervals."""
    made = {}
    for number in sorted(network["particles"].unique()) if len(network) else ():
        for each in variants(WALLED):
            rows = pick(network, particles=number, packing=each.packing, held=each.held)
            if len(rows):
                names = ("error_10s", "worst")
                made[each, int(number)] = {
                    name: interval(rows[f"{name}_{each.calibration}"].to_numpy(dtype=float)) for name in names
                }
    return made
