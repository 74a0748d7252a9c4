"""Memory that a solve on voxels is expected to take, told before it begins."""

# Fields of one number a voxel that are there at the peak, by scheme and rule: temperature, residual, direction and the
# transform's own; conductivities of three links besides; three of the flux and three of the transform.
FIELDS = {("cg", "plain"): 4, ("cg", "laminate"): 4, ("cg", "links"): 7}
FIELDS |= {("eyre-milton", "plain"): 6, ("eyre-milton", "laminate"): 6}
# What the solution of each load keeps, of several on one set-up.
KEPT = {"cg": 1, "eyre-milton": 3}
# Bytes of a voxel's phase; and, in double precision, of a voxel's own tensor, in a scene that has one: six numbers and
# its place, twice while they are sorted.
PHASE, OWN = 2, 70
# Links are found in double precision.
LINKS = 3 * 8


def expected(scheme: str, rule: str, itemsize: int, *, loads: int = 1, anisotropic: bool = False) -> float:
    """Bytes for each voxel at the peak, besides Python and libraries, and what surfaces of inclusions take."""
    fields = FIELDS[scheme, rule] + KEPT[scheme] * (loads - 1)
    links = LINKS if rule == "links" and itemsize < 8 else 0
    return fields * itemsize + links + PHASE + (OWN * itemsize / 8 if anisotropic else 0)
