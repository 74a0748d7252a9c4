"""Figures as files: the same from the same rows, vector copies of bearable size, small pictures inside of a page."""

import base64
import io

import numpy as np
import pytest

from studies.harness import pictures
from studies.harness.figures import STYLE

plt = pytest.importorskip("matplotlib.pyplot")
Image = pytest.importorskip("PIL.Image")


def drawn(draw):
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(3, 2))
        draw(axes)
        return figure


def saved(draw, path):
    figure = drawn(draw)
    with plt.rc_context(STYLE):
        found = pictures.saved(figure, path)
    plt.close(figure)
    return found


def test_the_same_figure_is_the_same_file(tmp_path):
    def draw(axes):
        axes.plot([1, 2, 3], "o-", clip_on=True, label="a line")
        axes.legend()

    one, two = (saved(draw, tmp_path / name) for name in ("one.png", "two.png"))
    assert [path.suffix for path in one] == [".png", ".svg"]
    assert one[1].read_bytes() == two[1].read_bytes() and b"<dc:date>" not in one[1].read_bytes()
    assert b"<image" not in one[1].read_bytes()


@pytest.mark.parametrize("many", ["scatter", "line", "mesh"])
def test_very_many_points_are_pixels_in_the_vector_copy(many, tmp_path, monkeypatch):
    monkeypatch.setattr(pictures, "MANY", 50)
    x = np.linspace(0, 1, 100)
    draws = {
        "scatter": lambda axes: axes.scatter(x, x**2),
        "line": lambda axes: axes.plot(x, x**2, "."),
        "mesh": lambda axes: axes.pcolormesh(np.outer(x[:10], x[:10])),
    }
    text = saved(draws[many], tmp_path / "many.png")[1].read_text()
    assert "<image" in text and "<text" not in text and text.count("<use") < 60


def test_a_large_vector_copy_is_not_kept(tmp_path, monkeypatch):
    saved(lambda axes: axes.plot([1, 2]), tmp_path / "figure.png")
    monkeypatch.setattr(pictures, "LARGEST", 1000)
    assert saved(lambda axes: axes.plot([1, 2]), tmp_path / "figure.png") == [tmp_path / "figure.png"]
    assert not (tmp_path / "figure.svg").exists()


def test_a_picture_inside_of_a_page_is_small(tmp_path, monkeypatch):
    saved(lambda axes: axes.imshow(np.random.default_rng(0).random((40, 40))), tmp_path / "figure.png")
    monkeypatch.setattr(pictures, "WIDEST", 200)
    head, _, code = pictures.embedded(tmp_path / "figure.png").partition(",")
    raw = base64.b64decode(code)
    assert head == "data:image/png;base64" and len(raw) < (tmp_path / "figure.png").stat().st_size
    with Image.open(io.BytesIO(raw)) as small, Image.open(tmp_path / "figure.png") as whole:
        assert small.width == 200 and small.height == round(whole.height * 200 / whole.width)


def titles(figure):
    with plt.rc_context(STYLE):
        pictures.lettered(figure)
    plt.close(figure)
    return [axes.get_title(loc="left") or axes.get_title() for axes in pictures.panels_of(figure)]


def test_panels_have_letters_in_order_and_bars_of_colour_none():
    with plt.rc_context(STYLE):
        figure, ((one, two), (three, four)) = plt.subplots(2, 2)
    one.set_title("first", fontsize=7)
    two.set_title("middle", loc="center")
    three.twinx()
    four.inset_axes((0.5, 0.5, 0.4, 0.4))
    figure.colorbar(four.imshow([[0.0, 1.0]]), ax=four)
    assert titles(figure) == ["(a) first", "(b) middle", "(c)", "(d)"]
    size = next(each.get_fontsize() for each in one.get_children() if getattr(each, "get_text", str)() == "(a) first")
    assert size == 7


def test_a_single_panel_has_no_letter_nor_have_more_than_there_are():
    assert titles(drawn(lambda axes: axes.set_title("alone"))) == ["alone"]
    with plt.rc_context(STYLE):
        figure, _ = plt.subplots(3, 9)
    assert set(titles(figure)) == {""}


def test_powers_stand_raised_and_formulas_as_they_are(tmp_path):
    def draw(axes):
        axes.plot([1, 2], label="128^3 voxels, cm^-1")
        axes.set(title=r"$x^2$", xlabel="a^b")
        axes.legend()

    figure = drawn(draw)
    with plt.rc_context(STYLE):
        pictures.saved(figure, tmp_path / "raised.png")
    (axes,) = figure.axes
    assert axes.get_legend().get_texts()[0].get_text() == "128³ voxels, cm⁻¹"
    assert (axes.get_title(loc="left"), axes.get_xlabel()) == (r"$x^2$", "a^b")
    plt.close(figure)
