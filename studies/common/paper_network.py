"""The paper's network in all the ways that its words allow: two packings, three kinds of walls, two calibrations.

Haddad et al. (Int. J. Thermal Sciences 164, 2021, 106799) let hard spheres grow (LSA), put the temperatures of walls
into the centres of the particles there and calibrate C_t under a flux. Here each of the three is taken in other ways,
too: spheres may overlap and be pushed apart ("relaxed"); temperatures may act at the wall's own surface, or there are
no walls at all ("periodic", where the scene has an equal that is); and C_t may be calibrated between two isothermal
walls. In a periodic cell there is one calibration, under the mean gradient ("cell").

All links scale with C_t, so that one solve serves both calibrations: the particles' steady temperatures do not depend
on it, fluxes and the conductivity are in proportion. A row is one packing under one kind of walls: conductivities and
fluxes in it are those with C_t = 1, and `ct_flux`, `ct_isothermal` or `ct_cell` are what they are to be multiplied by.
Solved is with the last of these, as what is read between particles goes with their flux.
"""

NAME = "network"
PACKINGS = ("lsa", "relaxed")
WALLED = ("center", "surface")
HELD = (*WALLED, "periodic")
SEEDS = (0, 1, 2)
# Reduced pressure at which the spheres stop to grow, as in `fig03_calibration`: phi = 0.641 in a periodic cell.
PRESSURE = 120.0


def cases(numbers, *, held=HELD, packings=PACKINGS, seeds=SEEDS, replicas=1):
    """Cases of the network: every packing under every kind of walls.

    Their method is `NAME`: a study's `MODULES` names what they run, so that its other rows do not change with it. There
    it is spelt out, as all that `run` reaches counts in the code of every row.
    """
    repeated = {} if replicas == 1 else {"replicas": replicas}
    for number in numbers:
        for packing in packings:
            for walls in held:
                here = {"name": NAME, "packing": packing, "held": walls, "particles": number}
                yield from (here | {"seed": seed} | repeated | {"method": NAME} for seed in seeds)


def once(number):
    """Cases of one packing of each kind under every kind of walls; of relaxed ones without walls more."""
    yield from cases([number], seeds=SEEDS[:1])
    yield from cases([number], held=["periodic"], packings=["relaxed"], seeds=SEEDS[1:])


def calibrations(held):
    """Names of the calibrations that differ under a kind of walls."""
    return ("cell",) if held == "periodic" else ("flux", "isothermal")


def packed(size, packing, held, particles, seed, replicas=1):
    """Packing in a box, kept in the cache: one for all scenes of its shape."""
    from demheat.packing.cache import grown, relaxed

    here = {"size": [side / replicas for side in size], "periodic": held == "periodic", "seed": seed}
    particles //= replicas**3
    if packing == "lsa":
        return grown(particles, pressure=PRESSURE, domain="box", **here)
    return relaxed(particles, **here)


def unit_law(packing, held):
    """The paper's law with C_t = 1 on a packing, its gap found once."""
    from demheat.laws import Calibrated
    from demheat.packing.neighbours import contacts

    gap = contacts(packing, coordination=Calibrated.usual)[2]
    return Calibrated(gap=gap, wall="surface" if held == "surface" else "center", factor=1.0)


def calibrated(packing, law, held):
    """C_t of a packing by every calibration that its walls allow."""
    from demheat.dem.calibration import calibration
    from demheat.dem.networks import network_of
    from demheat.scene import Material, Scene

    load = {"gradient": (0.0, 1.0, 0.0)} if held == "periodic" else {"walls": {"y-": 0.0, "y+": 1.0}}
    scene = Scene(size=tuple(packing.size), matrix=Material(1.0), **load)
    network = network_of(scene, packing, law)
    found = {}
    for name in calibrations(held):
        loading = "flux" if name == "flux" else "isothermal"
        found[f"ct_{name}"] = float(calibration(network, scene, loading=loading))
    return found


def solved(scenes, packing, held, replicas=1):
    """Fields of scenes of one box by one packing, and its C_t."""
    row, each = in_turn(scenes, packing, held, replicas)
    fields = dict(each)
    return fields, row | told(list(fields.values())[-1])


def in_turn(scenes, packing, held, replicas=1):
    """C_t of a packing, and names and fields of scenes of one box by it, one after another: large ones fill memory."""
    from dataclasses import replace

    from demheat import dem
    from demheat.packing.domain import replicate

    law = unit_law(packing, held)
    row = calibrated(packing, law, held)
    law = replace(law, factor=list(row.values())[-1])
    whole = replicate(packing, (replicas,) * 3) if replicas > 1 else packing
    return row, ((name, dem.solve(scene, law=law, packing=whole)) for name, scene in scenes.items())


def told(field):
    """What a row keeps of how a field was found."""
    return {name: field.stats.get(name) for name in ("unknowns", "iterations", "residual", "mean_radius")}


def fields_and_row(scenes, packing, held, particles, seed, replicas=1):
    """Scenes of one box by one packing of a case: their fields, and the row of the case."""
    one = packed(_size(scenes), packing, held, particles, seed, replicas)
    fields, row = solved(scenes, one, held, replicas)
    return fields, row | {column: unscaled(field) for column, field in fields.items()}


def row_of(scenes, packing, held, particles, seed, replicas=1):
    """The row of a case alone, no two of whose fields are there at once."""
    one = packed(_size(scenes), packing, held, particles, seed, replicas)
    row, each = in_turn(scenes, one, held, replicas)
    for column, field in each:
        row |= told(field) | {column: unscaled(field)}
    return row


def _size(scenes):
    return next(iter(scenes.values())).size


def unscaled(field):
    """Conductivity with C_t = 1 over the matrix's."""
    return field.conductivity / (field.scene.matrix.conductivity * field.stats["calibration"])
