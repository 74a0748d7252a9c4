"""Cases that several studies have in common; light, since every listing of studies loads it."""


def laws_by_size(numbers, laws, seeds):
    """Cases of the DEM: each number of particles by each (law, coordination), packing by packing."""
    for particles in numbers:
        for law, coordination in laws:
            for seed in seeds:
                case = {"law": law, "coordination": coordination, "particles": particles, "seed": seed}
                yield case | {"method": "dem"}
