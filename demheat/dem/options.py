"""What is asked of `solve` and `evolve`: read and checked once, before any heavy work; and what memory it takes."""

import copy
import warnings
from dataclasses import dataclass, replace

import numpy as np

from demheat.laws import Calibrated, Laguerre, Law, Platonic
from demheat.packing.base import Packing
from demheat.packing.cache import relaxed, replicated
from demheat.packing.domain import replica_counts
from demheat.packing.gate import check_packing
from demheat.packing.relax import FEWEST
from demheat.packing.tile import fits, tiled
from demheat.packing.twins.conforming import faces
from demheat.runtime.limits import check_memory
from demheat.scene import Scene
from demheat.scene.inputs import flag, whole

# Packing fraction below which a packing that is given is called loose: crystals of equal spheres begin at .34, diamond.
LOOSE = 0.3
# Least bytes that a particle takes, found from 560 to 800 where they are many.
BYTES = 500
SHARED = ", or demheat.mpi, which shares the body out to processes of several machines"
MIB = 2**20
# Bytes at the peak for each unknown, and for each of the rows that are worked on at once. Found between walls with a
# sphere of contrast 5, by law "laguerre": 929 an unknown of 212 thousand, 678 of 1.03 million.
EACH, ROW, ROWS = 613, 1020, 65536
# Twins less the particles that give way to them, for each squared mean radius of the faces of an inclusion's bounds.
TWINS = 0.37
# Of the volume, that spheres fill.
PHI = 0.64


@dataclass(frozen=True, kw_only=True)
class Particles:
    """The packing that is asked for: given, or so many particles to be relaxed in the scene's body."""

    particles: int
    seed: int
    packing: Packing | None = None
    replicas: int | None = None  # Along the shortest side of the box, where particles are packed
    allow_few: bool = False

    def __post_init__(self):
        flag("allow_few", self.allow_few)
        number = whole("particles", self.particles, "an integer >= 1", lambda v: v >= 1)
        whole("seed", self.seed, "an integer >= 0", lambda v: v >= 0)
        if self.packing is not None:
            check_packing(self.packing)
        if self.packing is None and number < FEWEST and not self.allow_few:
            raise ValueError(f"particles = {number!r}: fewer than {FEWEST}; pass allow_few=True if you mean it")
        if self.packing is not None and self.replicas is not None:
            raise ValueError(f"replicas = {self.replicas!r} of a packing that is given: must be None")

    def check(self, scene: Scene, law: Laguerre | Calibrated | Platonic) -> None:
        """Refuse what does not suit a scene and a law."""
        if self.packing is not None:
            _check_body(self.packing, scene)
        elif not self.is_tiled(scene, law):
            self.repeats(scene, law)
        if self.replicas is not None and replace(self, replicas=None).is_tiled(scene, law):
            warnings.warn(
                f"replicas = {self.replicas!r} of a packing: conforming cells need none, tiles cost nothing and are as "
                "accurate; for them replicas will be refused",
                DeprecationWarning,
                stacklevel=5,
            )

    def repeats(self, scene: Scene, law: Laguerre | Calibrated | Platonic) -> np.ndarray:
        """How often a packing that is made repeats a smaller one along each axis, (3,) int array."""
        if scene.domain == "box" and (scene.periodic or law.cells):
            return replica_counts(self.particles, scene.size, self.replicas)
        if self.replicas is not None and self.replicas != 1:
            raise NotImplementedError(
                f"replicas in a {scene.domain} with walls and law {law.name!r}: only in boxes by 'laguerre'"
            )
        return np.ones(3, dtype=int)

    def is_tiled(self, scene: Scene, law: Laguerre | Calibrated | Platonic) -> bool:
        """Whether particles need not be packed: cells with twins in boxes."""
        ours = law.conforming and scene.domain == "box" and self.packing is None and self.replicas is None
        return ours and fits(self.particles, scene.size, scene.periodic)

    def packed(self, scene: Scene, law: Laguerre | Calibrated | Platonic) -> Packing:
        """The packing that was given, or tiles, or a relaxed one in the scene's body, or replicas of one."""
        if self.packing is not None:
            return _own(self.packing)
        body = {"size": scene.size, "periodic": scene.periodic, "seed": self.seed}
        if self.is_tiled(scene, law):
            return tiled(self.particles, **body)
        counts = self.repeats(scene, law)
        if counts.prod() > 1:
            return replicated(self.particles, counts, **body)
        domain = {} if scene.domain == "box" else {"domain": scene.domain}
        return relaxed(self.particles, allow_few=self.allow_few, **body, **domain)


def expected_unknowns(scene: Scene, law: Laguerre | Calibrated | Platonic, wanted: Particles) -> float:
    """How many unknowns a packing is expected to have with its twins; those in narrow gaps are not foreseen."""
    number = float(wanted.particles if wanted.packing is None else wanted.packing.number)
    if not (law.conforming and scene.inclusions):
        return number
    unit = np.cbrt(0.75 / np.pi * PHI * scene.volume / number)
    return number + TWINS * float(faces(scene).sum() / unit**2)


def expected_bytes(number: float) -> float:
    """Bytes that a steady solve is expected to take at its peak, besides Python and libraries."""
    return EACH * number + ROW * min(number, ROWS)


def check_fits(wanted: Particles, law: Law) -> None:
    """Refuse more particles than the memory holds."""
    if wanted.packing is None:
        remedy = SHARED if isinstance(law, Laguerre) else ""
        check_memory("particles", wanted.particles, BYTES * int(wanted.particles), remedy=remedy)


def _own(packing):
    """A copy of a packing that is given: what its owner does to it later is none of the field's."""
    arrays = {name: getattr(packing, name).copy() for name in ("centers", "radii", "size", "periodic")}
    return packing._replace(**arrays, provenance=copy.deepcopy(dict(packing.provenance)))


def _check_body(packing, scene):
    like = packing.domain == scene.domain and set(packing.periodic.tolist()) == {scene.periodic}
    if not (like and np.allclose(packing.size, scene.size, rtol=1e-9)):
        kind = "periodic" if scene.periodic else "walled"
        raise ValueError(
            f"packing of size {packing.size.tolist()} in a {packing.domain}, periodic {packing.periodic.tolist()}: "
            f"must be {kind}, in the scene's {scene.domain} of size {scene.size}"
        )
    if packing.phi < LOOSE:
        warnings.warn(
            f"packing: its spheres fill {packing.phi:.3g} of the body: too far apart for many contacts and for "
            "round cells, so that results may be off by percents; at 0.5 and more the method is at home",
            stacklevel=4,
        )
