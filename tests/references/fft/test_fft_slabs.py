"""Slabs of a grid hold the voxels of the whole, and their ranks find its field, whatever their number."""

import threading

import numpy as np
import pytest
from fft_scenes import dispersion
from ranks import on_ranks
from scipy import fft as scipy_fft

import demheat.beyond.ranks
from demheat import Image, Material, Scene
from demheat.scene import Cylinder
from references import fft
from references.fft import harmonic, ranks
from references.fft.pencils import most_ranks, share
from references.fft.slabs import painted, slab_of
from references.voxels.paint import voxelise

# Drawn where they are asked for: whoever lists the tests would compile what draws them.
SCENES = {
    "cell": lambda: dispersion(gradient=(0.3, 1.0, -0.5)),
    "walls": lambda: dispersion(walls={"y-": 20.0, "y+": 30.0}),
    "rod": lambda: rod(20.0),
}


def rod(conductivity):
    one = Cylinder((0.9, 0.2, 0.3), 0.2, (1.0, 0.3, 0.2), Material(conductivity), length=0.5)
    return Scene((1.0, 1.2, 0.9), Material(1.0), [one], gradient=(1.0, 0.0, 0.0))


SHAPE = (9, 12, 8)


class Gathered:
    """What `pencils.Pencils` does, by transforms of the whole on every rank."""

    def __init__(self, shape, walls, comm):
        self.comm, self.walls, self.seconds = comm, walls, 0.0
        self.counts = (shape[0], shape[1] if walls else shape[1] // 2 + 1, shape[2])
        self.planes, self.rows = (slice(*share(n, comm.size, comm.rank)) for n in (shape[0], self.counts[1]))
        self.real, self.shape = np.zeros((self.planes.stop - self.planes.start, *shape[1:])), shape
        whole = 8 * (shape[0] + 1) * (shape[1] - 1) * (shape[2] - 1) if walls else np.prod(shape)
        self.scale, self.modes = 1.0 / whole, None

    def forward(self):
        values = np.concatenate(self.comm.allgather(self.real))
        if self.walls:
            modes = scipy_fft.dst(scipy_fft.dctn(values, type=1, axes=(1, 2)), type=1, axis=0)
        else:
            modes = scipy_fft.fft(scipy_fft.rfftn(values, axes=(2, 1)), axis=0)
        self.modes = modes[:, self.rows].copy()

    def backward(self):
        modes = np.concatenate(self.comm.allgather(self.modes), axis=1)
        if self.walls:
            values = scipy_fft.dst(scipy_fft.dctn(modes, type=1, axes=(1, 2)), type=1, axis=0)
        else:
            lines, sides = scipy_fft.ifft(modes, axis=0, norm="forward"), (self.shape[2], self.shape[1])
            values = scipy_fft.irfftn(lines, s=sides, axes=(2, 1), norm="forward")
        self.real[...] = values[self.planes]

    def free(self):
        pass


@pytest.fixture
def on_threads(monkeypatch):
    """A function of a number of ranks and of some work, which may call `ranks.solve`."""
    here = threading.local()
    monkeypatch.setattr(ranks, "world", lambda: here.comm)
    monkeypatch.setattr(ranks, "Pencils", Gathered)
    monkeypatch.setattr(demheat.beyond.ranks, "here", lambda comm: comm.size)

    def run(number, work):
        def rank(comm):
            here.comm = comm
            return work()

        return on_ranks(number, rank)

    return run


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("laminate", [True, False])
def test_slabs_are_painted_as_the_whole(name, laminate):
    scene = SCENES[name]()
    whole = voxelise(scene, SHAPE, laminate=laminate)
    plane = SHAPE[1] * SHAPE[2]

    def work(comm):
        slab = slab_of(SHAPE, not scene.periodic, comm)
        return slab, painted(scene, slab, laminate=laminate)

    for slab, held in on_ranks(4, work):
        planes = np.arange(slab.low - 1, slab.high + 1) % SHAPE[0]
        np.testing.assert_array_equal(held.phase, whole.phase[planes])
        # Bit for bit: a voxel that changes its phase is seen.
        numbers = planes[held.cut // plane] * plane + held.cut % plane
        np.testing.assert_array_equal(held.tensor, whole.tensor[np.searchsorted(whole.cut, numbers)])
        assert len(held.cut) == np.isin(whole.cut // plane, planes).sum() and np.all(np.diff(held.cut) > 0)
        np.testing.assert_allclose(held.fractions, whole.fractions, rtol=1e-14, atol=1e-16)


# Few voxels warn of gaps.
@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(("name", "rule"), [("cell", "laminate"), ("walls", "laminate"), ("walls", "plain")])
@pytest.mark.parametrize("number", [1, 3])
def test_ranks_find_the_field_of_one_process(name, rule, number, on_threads, monkeypatch):
    # Fits reach beyond the planes of a rank, which interpolates.
    monkeypatch.setattr(harmonic, "suits", lambda grid: False)
    scene = SCENES[name]()
    # Far from what is found by chance, and not so near to rounding that one of the two goes on longer.
    knobs = {"voxels": SHAPE, "rule": rule, "tolerance": 1e-9}
    points = np.random.default_rng(0).random((40, 3)) * scene.size

    def work():
        field = ranks.solve(scene, **knobs)
        # Of one point most ranks have none.
        assert field.temperature_at(points[0]) == field.temperature_at(points)[0]
        # Python 3.11 makes cached properties one thread at a time, of all objects: not `field.samples`.
        return field, field.temperature_at(points), field.flux_at(points), field.sampler()

    whole = fft.solve(scene, threads=1, **knobs)
    for field, temperature, flux, samples in on_threads(number, work):
        assert field.stats["ranks"] == number and field.stats["voxels"] == SHAPE
        # Transforms round otherwise, nothing else: some 1e-15, and a hundred iterations.
        np.testing.assert_allclose(field.mean_flux, whole.mean_flux, rtol=0, atol=1e-11 * np.abs(whole.mean_flux).max())
        for name, heat in whole.wall_heat.items():
            assert field.wall_heat[name] == pytest.approx(heat, rel=1e-11)
        assert field.stats["unknowns"] == whole.stats["unknowns"]
        # Only they show what preconditions; rounding may make one more.
        assert abs(field.stats["iterations"] - whole.stats["iterations"]) <= 1
        # Of the field a tolerance of 1e-9 leaves as much.
        np.testing.assert_allclose(temperature, whole.temperature_at(points), rtol=0, atol=1e-8)
        np.testing.assert_allclose(flux, whole.flux_at(points), rtol=0, atol=1e-7)
        for name, near in (("points", 1e-14), ("volumes", 1e-14), ("phase", 0), ("temperature", 1e-8), ("flux", 1e-7)):
            ours, theirs = getattr(samples, name), getattr(whole.samples, name)
            np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=near)


def test_images_and_tensors_are_shared_out_too(on_threads):
    labels = (np.random.default_rng(1).random((6, 5, 7)) < 0.4).astype(np.uint8)
    tensor = [[3.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]
    image = Image(labels, voxel=1e-3, materials={0: Material(1.0), 1: Material(tensor)})
    scene = Scene.of_image(image, gradient=(1.0, 0.0, 0.0))
    whole = fft.solve(scene, tolerance=1e-9, threads=1).mean_flux
    for found in on_threads(2, lambda: ranks.solve(scene, tolerance=1e-9).mean_flux):
        np.testing.assert_allclose(found, whole, rtol=0, atol=1e-11 * np.abs(whole).max())


@pytest.mark.parametrize(
    ("knobs", "kind", "told"),
    [
        ({"rule": "links"}, NotImplementedError, "scheme 'cg', rule 'links': fft on ranks solves"),
        ({"scheme": "eyre-milton"}, NotImplementedError, "scheme 'eyre-milton'"),
        ({"rule": "cubes"}, ValueError, "rule = 'cubes': must be one of"),
        ({"voxels": (2, 12, 8)}, ValueError, r"ranks = 3: .* must be at most 2"),
        ({"voxels": 1200}, ValueError, r"voxels = 1200: takes .* GiB of memory or more"),
    ],
)
def test_what_is_not_done_is_refused_before_anything_heavy(knobs, kind, told, on_threads, monkeypatch):
    scene = SCENES["cell"]()
    monkeypatch.setattr(ranks, "painted", None)
    monkeypatch.setattr(demheat.runtime.limits, "free_memory", lambda: 2.0**30)

    def work():
        with pytest.raises(kind, match=told):
            ranks.solve(scene, **{"voxels": 8, **knobs})

    on_threads(3, work)


def test_pores_are_refused():
    with pytest.raises(NotImplementedError, match="where all phases conduct"):
        ranks.solve(rod(0.0), voxels=8)


def test_planes_are_shared_out_evenly():
    shares = [share(11, 4, rank) for rank in range(4)]
    assert shares == [(0, 3), (3, 6), (6, 9), (9, 11)]
    assert most_ranks((8, 9, 4), walls=False) == 5 and most_ranks((8, 9, 4), walls=True) == 8
