"""Only here: a page that needs another file, shows another scene, or draws nothing in a browser."""

import base64
import json
import re
import shutil
import subprocess
import zlib
from html.parser import HTMLParser

import numpy as np
import pytest

from demheat import Image, Layer, Material, Scene, gallery
from demheat.io import scenes
from demheat.terminal.commands import main

pytest.importorskip("matplotlib")
BROWSER = next(filter(None, map(shutil.which, ("chromium-headless-shell", "chromium", "google-chrome"))), None)


class Tags(HTMLParser):
    """All that a page refers to, and its text."""

    def __init__(self, text):
        super().__init__()
        self.sources, self.words = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.sources += [value for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data):
        self.words.append(data)


def report(path, *words):
    assert main(["report", str(path), *words, "--out", str(path.with_suffix(".html"))]) == 0
    text = path.with_suffix(".html").read_text(encoding="utf-8")
    return text, json.loads(re.search(r'view\(document.querySelector\("\.view"\), (.*)\);</script>', text)[1])


def grid(part):
    """Bytes of a volume, (nx, ny, nz) array."""
    packed = zlib.decompress(base64.b64decode(part["content"]))
    return np.frombuffer(packed, np.uint8).reshape(part["shape"][::-1]).transpose()


def middles(shape, size):
    axes = [(np.arange(n) + 0.5) / n * side for n, side in zip(shape, size, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def test_the_page_holds_scene_fields_and_answers(tmp_path, capsys):
    path = tmp_path / "wall.toml"
    # Of three unlike sides, so that axes cannot be mixed up.
    layer = Layer(0, 0.02, 0.05, Material(5.0))
    scene = Scene((0.1, 0.2, 0.15), Material(1.0), [layer], walls={"x-": 20.0, "x+": 30.0})
    scenes.write(scene, path)
    text, data = report(path, "--methods", "exact,maxwell,fft", "--knob", "voxels=16")
    found = Tags(text)
    # Nothing from elsewhere.
    assert found.sources and all(each.startswith("data:image/png;base64,") for each in found.sources)
    words = " ".join(" ".join(found.words).split())
    k = 0.1 / (0.07 / 1.0 + 0.03 / 5.0)
    assert str(k)[:8] in words and "maxwell refused: " in words and "exact to" in words
    assert "Faces other than x-, x+ are insulated" in words and "@software{demheat" in words
    assert path.read_text(encoding="utf-8").splitlines()[0] in text
    kinds = grid({"content": data["kinds"], "shape": data["shape"]})
    assert np.array_equal(kinds.ravel(), scene.phase_at(middles(data["shape"], scene.size)))
    assert data["size"] == pytest.approx([0.5, 1.0, 0.75]) and [each[3] for each in data["colours"]] == [0.0, 1.0]
    warmth = grid(data["values"][0]).astype(float).reshape(data["values"][0]["shape"])
    # From 1 to 255, rising along x alone.
    assert warmth.min() == 1 and warmth.max() == 255 and np.all(np.diff(warmth[:, 0, 0]) > 0)
    assert np.ptp(warmth, axis=(1, 2)).max() <= 1


def test_a_page_of_an_image_is_cut_at_its_voxels(tmp_path):
    labels = np.random.default_rng(3).choice([0, 2, 7], (4, 5, 6))
    materials = {0: Material(1.0), 2: Material(3.0), 7: Material(0.0)}
    scenes.write(Scene.of_image(Image(labels, 1e-6, materials), gradient=(0, 1, 0)), tmp_path / "scan.toml")
    text, data = report(tmp_path / "scan.toml", "--method", "fft")
    assert data["shape"] == [72, 90, 108]
    kinds = grid({"content": data["kinds"], "shape": data["shape"]})
    place = {0: 0, 2: 2, 7: 1}  # The first phase's conductivity, then the others' in ascending order
    assert np.array_equal(kinds[9::18, 9::18, 9::18], np.vectorize(place.get)(labels))
    assert "stairs for smooth surfaces" in text and "Pores conduct nothing" in text
    # Pores have no temperature.
    warmth = grid(data["values"][0])
    assert np.array_equal(warmth[3::6, 3::6, 3::6] == 0, labels == 7)


def test_where_the_page_goes_is_looked_at_before_anything_is_solved(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("demheat.terminal.commands.report.answered", lambda *_: pytest.fail("solved"))
    scenes.write(gallery.laminate(), tmp_path / "scene.toml")
    assert main(["report", str(tmp_path / "scene.toml"), "--out", str(tmp_path / "none" / "x.html")]) == 2
    assert "there is no folder" in capsys.readouterr().err


# What a browser is to do with the page, and to say of it: the colours of the canvas before and after it is turned.
ACT = """<script>addEventListener("load", () => setTimeout(() => {
  const canvas = document.querySelector("canvas");
  const seen = () => { const own = document.createElement("canvas"); own.width = own.height = 16;
    const at = own.getContext("2d"); at.drawImage(canvas, 0, 0, 16, 16);
    return [...at.getImageData(0, 0, 16, 16).data].reduce((sum, value, k) => (31 * sum + value) % 1000003, 7); };
  const told = [seen()], next = (change, then) => { change(); setTimeout(() => { told.push(seen()); then(); }, 1500); };
  const input = (which, value) => () => { const each = document.querySelector(which); if (value) each.value = value;
    else each.checked = true; each.dispatchEvent(new Event("input")); };
  const key = () => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
  next(key, () => next(input("[data-kind='0']"), () => next(input("[data-cut='2']", "0.4"),
    () => next(input("[name=field][value='0']"), () => {
      document.body.insertAdjacentHTML("beforeend", `<i id="told">${told.join(",")}</i>`); }))));
}, 3000));</script></body>"""


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no Chromium here")
def test_a_browser_draws_it_and_turns_it(tmp_path):
    path = tmp_path / "cube.toml"
    scenes.write(gallery.sphere_in_cube(5.0), path)
    text, _ = report(path, "--method", "fft", "--knob", "voxels=16")
    path.with_suffix(".html").write_text(text.replace("</body>", ACT), encoding="utf-8")
    flags = "--no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --window-size=500,700"
    words = [BROWSER, "--headless", *flags.split(), "--virtual-time-budget=20000", "--dump-dom"]
    done = subprocess.run(
        [*words, path.with_suffix(".html").as_uri()], capture_output=True, text=True, timeout=120, check=False
    )
    if 'class="view live"' not in done.stdout:
        pytest.skip("this browser has no WebGL 2 here")
    told = re.search(r'<i id="told">([\d,]+)</i>', done.stdout)[1].split(",")
    # Turned, with the matrix shown, cut, and by temperature: five pictures.
    assert len(set(told)) == 5, told
