"""The rooms of the house, and what each may import."""

from rooms_above import ABOVE
from rooms_beside import BESIDE

# Rooms from the ground up: modules (each with all below it), and rooms before it, or modules of others, on which it
# stands. That inside of a room nothing goes in circles is asked by `test_circles.py`.
ENGINE = {
    "scene": (("demheat.scene",), ()),
    # What all computing runs on. Kept packings go by the text of `powers` and `addition`: where these lie stays.
    "runtime": (("demheat.runtime", "demheat.powers", "demheat.addition", "demheat.version"), ("scene",)),
    # What all methods share.
    "nouns": (
        (
            *("demheat.gate", "demheat.error", "demheat.extrapolation", "demheat.splitting"),
            *("demheat.field", "demheat.tensor"),
            *("demheat.laws", "demheat.method"),
        ),
        ("scene",),
    ),
    # No method knows it.
    "referee": (("demheat.referee",), ("scene", "nouns")),
    # Ranks of an MPI run, and workers of Dask, for whoever computes on them.
    "beyond": (("demheat.beyond",), ("runtime",)),
    "packing": (("demheat.packing", "demheat.gallery"), ("scene", "runtime")),
    "statistics": (("demheat.packing.statistics",), ("scene", "runtime", "packing")),
    "network": (("demheat.network",), ("scene", "runtime", "nouns", "packing")),
    "conduction": (("demheat.conduction",), ("scene", "runtime", "network")),
    "sampling": (("demheat.sampling",), ("scene", "runtime", "nouns", "network", "conduction")),
    # The whole way: calibration of a law is a steady solve, so what joins packings to networks stands up here.
    "dem": (
        ("demheat.dem",),
        ("scene", "runtime", "nouns", "packing", "network", "conduction", "sampling"),
    ),
    "damage": (
        ("demheat.damage",),
        ("scene", "runtime", "nouns", "packing", "network", "conduction", "sampling", "dem"),
    ),
}
# Above the witnesses: what knows all methods, or joins them.
UPPER = {
    # Finds methods where they are declared, by name alone: a method of one's own is found, too.
    "declared": (("demheat.declared",), ("nouns", "dem", "references")),
    # What methods cost and how far they are off, and the cheapest of them.
    "cheapest": (
        ("demheat.cheapest",),
        (
            *("scene", "runtime", "nouns", "dem", "references.bracket", "references.exact"),
            *("references.fem", "references.fft", "references.multipole"),
        ),
    ),
    # All that is read and written. A file of a scene names methods, and what they are told.
    "io": (("demheat.io",), ("scene", "runtime", "nouns", "packing", "declared")),
    # A model of its own, by the engine's packings and solver: beds of grains out of files.
    "grains": (
        ("demheat.grains",),
        ("scene", "runtime", "packing", "network", "conduction", "sampling", "io"),
    ),
    # One function over many cases: of what it returns it knows a Field and the tensor of `effective`.
    "sweeps": (("demheat.sweeps",), ("scene", "runtime", "nouns", "beyond", "cheapest")),
    # Commands and pictures. Nouns know nothing of these: the front gives them `plot` and `write`.
    "terminal": (
        ("demheat.terminal", "demheat.__main__"),
        (
            *("scene", "runtime", "nouns", "declared", "cheapest", "io"),
            *("references.bounds", "references.bracket.voxels", "references.exact"),
        ),
    ),
    # A big solve on several processes: the engine's own parts at work on slabs, and a command of its own.
    "mpi": (
        ("demheat.mpi",),
        (
            *("scene", "runtime", "nouns", "beyond", "packing", "network", "conduction", "sampling", "dem"),
            *("declared", "io", "terminal"),
        ),
    ),
    # What the package shows, what it gives to fields and scenes, and its old names.
    "front": (
        ("demheat", "demheat.renamed", "demheat.streamed"),
        ("scene", "runtime", "nouns", "packing", "dem", "cheapest", "io", "sweeps", "terminal"),
    ),
}
ROOMS = ENGINE | UPPER
# Packages whose own room is for their front alone.
FRONTS = ("demheat", "references", "benchmark")


def by_prefix(rooms):
    """Each prefix of modules with those that these may import; a room's own among them, but for a front."""
    return {
        prefix: tuple(
            module
            for other in (room, *below)
            for module in (ROOMS[other][0] if other in ROOMS else (other,))
            if module not in FRONTS or other != room
        )
        for room, (own, below) in rooms.items()
        for prefix in own
    }


# From the ground up; the longest prefix that fits a module says what it may import.
LAYERS = by_prefix(ENGINE) | BESIDE | by_prefix(UPPER) | ABOVE
