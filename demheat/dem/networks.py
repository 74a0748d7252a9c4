"""The one way from a packing to a network of conductances, whatever its law."""

import time
import warnings
from collections.abc import Sequence

import numpy as np

from demheat.dem.calibration import calibration, calibration_scene, cube_like
from demheat.laws import LAWS, ON_FACETS, Calibrated, Laguerre, Platonic, check_numbers
from demheat.network.base import Network
from demheat.network.bridges import bridged, needed
from demheat.network.calibrated import contact_facets
from demheat.network.interface import connect
from demheat.network.laguerre import drop_empty_cells, laguerre
from demheat.network.platonic import platonic_facets
from demheat.network.repeated import farthest_of, known_cells
from demheat.packing.base import Packing
from demheat.packing.gate import check_packing
from demheat.packing.twins.conforming import conformed
from demheat.runtime.limits import check_memory
from demheat.runtime.progress import stage
from demheat.scene import Scene, check_scene
from demheat.scene.narrows import STRONG, narrows
from demheat.scene.resistances import on_facets
from demheat.scene.volumes import coats, extents

# Layers thinner than so many particle diameters are seen by chance where facets do not lie on interfaces. Errors of a
# layer of .001 and of 1000 times the matrix's conductivity, over the exact value: at 2.4 diameters .05 and -.16, at 1.2
# diameters 2 and -.35, at .6 diameters 35 and -.75.
THIN = 1.5
# Coats that are followed all round leave less to chance; but where they conduct ten times better or worse than what is
# in them, one of .63 diameters was found to cost a quarter of the conductivity.
THIN_COAT, STRONG_COAT = 0.5, 1.0

# Gaps without twins, in particle diameters, and contrasts from which on they are said. Errors of a sphere between walls
# by 300 to 4000 particles, contacts that are calibrated and cells: gaps of 1.8 diameters 13 and 5 %, of 1.4 diameters
# 18 and 6 %, of 1.2 diameters 39 and 8 %; contacts at contrast 10 up to 25 %, at 5 up to 18 %, and 17 % they declare.
GAP, UNLIKE = 1.5, 7.0

# Twins over particles, and over the twins of wide gaps, from which on that is said: what takes six times as much as was
# asked for comes as a surprise.
MANY = 5
# Least bytes that a particle takes from here on.
BYTES = 400


def network_of(scene: Scene, packing: Packing, law: Laguerre | Calibrated | Platonic, *, seed: int = 0) -> Network:
    """The network of conductances that a law makes of a packing in a scene.

    Parameters
    ----------
    scene : Scene
        Its materials and, for what is calibrated, its load. `law.check(scene)` says what a law cannot do.
    packing : Packing
        In the scene's box and domain, periodic where the scene is.
    law : Laguerre, Calibrated or Platonic
    seed : int
        Of the pattern of twins at interfaces, where the law has them.

    Returns
    -------
    Network
        Of the particles that take part: those without a cell or with too few links to be kept are left out, twins are
        added. With all that `demheat.sampling.field_of.field_of` needs.

    Raises
    ------
    NotImplementedError
        If surfaces have a resistance and the law no facets on interfaces.
    ValueError
        If the law is none of these; or does not suit the packing, which may have no bulk, or no particles that touch
        its walls; or the twins in narrow gaps are more than fit into memory.

    Warns
    -----
    UserWarning
        If interfaces are so near to each other or to a wall that particles do not fit between them, or that twins are
        over five times as many as particles; if an inclusion holds no particle, or is thin for particles without twins,
        or a gap between good or bad conductors is.

    Examples
    --------
    >>> from demheat import Laguerre, gallery
    >>> from demheat.dem.networks import network_of
    >>> from demheat.packing.relax import relax
    >>> scene = gallery.slab(size=(1.0, 1.0, 1.0), periodic=True)
    >>> network = network_of(scene, relax(500, seed=0), Laguerre())
    >>> print(f"{network.volumes.sum():.9f}")  # cells fill the box
    1.000000000
    """
    check_scene(scene)
    return _connected(scene, law, *_tessellated(scene, packing, law, seed))


def networks_of(
    scenes: Sequence[Scene],
    packing: Packing,
    law: Laguerre | Calibrated | Platonic,
    *,
    seed: int = 0,
    perfect: np.ndarray | None = None,
) -> list[Network]:
    """The networks of one body under several loads: tessellated once, and one network where the loads do not matter.

    Phases that stand for perfect conductors stay joined where they touch.
    """
    cut = _tessellated(scenes[0], packing, law, seed)
    if law.factor is not None:
        return [_connected(scenes[0], law, *cut, perfect)] * len(scenes)
    return [_connected(scene, law, *cut, perfect) for scene in scenes]


def _tessellated(scene, packing, law, seed):
    """The particles that take part, their facets before they are calibrated, and the seconds that took."""
    if not isinstance(law, tuple(LAWS.values())):
        raise ValueError(f"law = {law!r}: must be a law, such as Laguerre() or Calibrated(wall='surface')")
    check_numbers(scene)
    scene.require(ON_FACETS, takes=tuple(each for each in law.takes if each != "perfect"))
    check_packing(packing)
    begun, known = time.perf_counter(), None
    if law.conforming:
        asked = packing
        how = {"seed": seed, "gap_spacing": law.gap_spacing, "farthest": farthest_of(asked)}
        made = conformed(asked, scene, **how)
        packing = made.packing
        check_memory("particles, twins in narrow gaps among them,", packing.number, BYTES * packing.number)
        warn_of_twins(packing, asked.number)
        known = known_cells(asked, made)
        del made, asked  # what is large
    return *_facets(packing, law, known), time.perf_counter() - begun


def _connected(scene, law, packing, facets, tessellation_s, perfect=None):
    """The network of facets in a scene."""
    begun = time.perf_counter()
    factor = _calibrated(scene, packing, facets, law) if law.factor is None else law.factor
    with stage("network"):
        # Wall areas are those of the walls: what scales is the conductance of their links.
        if factor != 1.0:
            facets = facets._replace(area=factor * facets.area)
        facets = facets._replace(wall_distance=facets.wall_distance / factor)
        phase = scene.phase_at(packing.centers)
        _warn_of_lost_phases(scene, phase)
        if not law.conforming:
            _warn_of_thin_phases(scene, phase, 2.0 * float(packing.radii.mean()))
            _warn_of_narrow_gaps(scene, 2.0 * float(packing.radii.mean()))
        how = {"rule": law.interface, "cells": law.cells, "resistance": on_facets(scene)}
        network = connect(packing, facets, phase, scene.conductivities, **how)
    spent = {"tessellation_s": tessellation_s, "network_s": time.perf_counter() - begun}
    said = {"law": law.name, "calibration": factor, "packing": packing.provenance}
    network = network._replace(stats=said | spent)
    return bridged(network, scene, perfect) if law.conforming and needed(packing.provenance, scene) else network


_CONTACTS = {Calibrated: contact_facets, Platonic: platonic_facets}


def _facets(packing, law, known=None):
    """The particles that take part, and their facets before they are calibrated."""
    if law.cells:
        body = {"periodic": packing.periodic, "domain": packing.domain}
        facets = laguerre(packing.centers, packing.radii**2, packing.size, known=known, **body)
    else:
        facets = _CONTACTS[type(law)](packing, law)
    return drop_empty_cells(packing, facets)


def _calibrated(scene, packing, facets, law):
    """C_t of a packing under a load like the scene's; of a sphere's in a cube of the same volume."""
    with stage("calibration"):
        if scene.domain == "sphere":
            packing = cube_like(packing)
            packing, facets = _facets(packing, law)
            scene = Scene(size=tuple(packing.size), matrix=scene.matrix, initial=0.0)
        flat = calibration_scene(scene)
        return calibration(connect(packing, facets, flat.phase_at(packing.centers), flat.conductivities), flat)


def warn_of_twins(packing: Packing, asked: int) -> None:
    """Warn of pairs of twins that do not fit into gaps, and of twins that are many times as many as particles.

    Twins stand as close as the gaps are narrow, down to a fifth of a mean radius: 64 times as many as elsewhere.
    """
    count, twins = packing.provenance["pairs_left_out"], packing.provenance["twins"]
    if count:
        warnings.warn(
            f"{count} pairs of particles do not fit into gaps narrower than a fifth of the mean particle; facets "
            "cross the interfaces there: use more particles where the gaps matter",
            stacklevel=5,
        )
    if twins > MANY * max(asked, packing.provenance["even_twins"]):
        warnings.warn(
            f"{twins} twins at interfaces, most of them in narrow gaps, stand beside {asked} particles: memory and "
            "time go with both; if that is too much, use more or fewer particles, or conforming=False",
            stacklevel=5,
        )


def _warn_of_thin_phases(scene, phase, diameter):
    """Without twins it is left to chance how many centres lie in what is thinner than a particle, or little thicker."""
    if not scene.inclusions:
        return
    across, coat = extents(scene), coats(scene)
    thickness = np.minimum(across, coat)
    seen = np.bincount(phase, minlength=len(scene.materials))[1:] > 0
    least = np.where(_strong_coats(scene), STRONG_COAT, THIN_COAT)
    thin = np.flatnonzero(((across < THIN * diameter) | (coat < least * diameter)) & seen)
    if len(thin):
        warnings.warn(
            f"inclusions {_few(thin)} are thin for particles of diameter {diameter:.3g} m (the thinnest is "
            f"{thickness[thin].min():.3g} m): what they do is left to chance; use more particles, or the conforming "
            "packing of law 'laguerre'",
            stacklevel=5,
        )


def _strong_coats(scene):
    """Whether each inclusion conducts `STRONG` times better or worse than one in it."""
    k, parents = scene.conductivities, scene.parents()
    strong = np.zeros(len(k), bool)
    for inner in range(1, len(k)):
        low, high = sorted((k[inner], k[parents[inner]]))
        strong[parents[inner]] |= high >= STRONG * low and high > 0
    return strong[1:]


def _warn_of_narrow_gaps(scene, diameter):
    """Links between particles on either side of a gap see nothing of it: good conductors are short-circuited."""
    near = np.flatnonzero(narrows(scene, GAP * diameter, UNLIKE)) if scene.domain == "box" else []
    if len(near):
        warnings.warn(
            f"gaps beside inclusions {_few(near)}, of a particle or so, are thin for particles of diameter "
            f"{diameter:.3g} m: links across them miss what is between, and the conductivity may be off many times; "
            "use more particles, or the conforming packing of law 'laguerre'",
            stacklevel=4,
        )


def _few(numbers):
    """The first of many numbers."""
    return f"{numbers[:8].tolist()}" + (f" and {len(numbers) - 8} more" if len(numbers) > 8 else "")


def _warn_of_lost_phases(scene, phase):
    lost = np.flatnonzero(np.bincount(phase, minlength=len(scene.materials)) == 0)
    # A phase may rightly be absent where later ones cover it: only the matrix can be.
    if scene.image is not None and len(lost):
        labels = [list(scene.image.materials)[number] for number in lost]
        warnings.warn(
            f"no particle lies in labels {_few(np.array(labels))} of the image, which take no part; use more particles",
            stacklevel=5,
        )
    elif np.any(lost > 0):
        warnings.warn(
            f"no particle lies in inclusions {(lost[lost > 0] - 1).tolist()}: they are thinner than a "
            "particle and take no part; use more particles",
            stacklevel=5,
        )
