"""A study's figure as files: PNG, a vector copy beside it, and small enough for a page that holds many."""

import base64
import io
import re
from pathlib import Path
from string import ascii_lowercase

from demheat.runtime.paths import replaced

# Beyond so many points, cells or paths an artist is pixels inside of the vector copy, too.
MANY = 2_000
# A larger vector copy, bytes, is not kept: the PNG says as much.
LARGEST = 2**20
# Powers in plain words, and digits and signs as they stand raised.
POWER, RAISED = re.compile(r"\^(-?\d+)"), str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Width, pixels, and colours of a picture inside of a page: nobody needs more on a screen.
WIDEST, COLOURS = 1_400, 128


def saved(figure, path):
    """Write a figure as PATH.png and PATH.svg and return the paths of the files there are."""
    picture, vector = (Path(path).with_suffix(end) for end in (".png", ".svg"))
    lettered(figure)
    raised(figure)
    with replaced(picture) as temporary:
        figure.savefig(temporary)
    pixels_for_many(figure)
    with replaced(vector) as temporary:
        # Neither a date nor names drawn at random: the same rows give the same file.
        figure.savefig(temporary, metadata={"Date": None})
    if vector.stat().st_size > LARGEST:
        vector.unlink()
    return [each for each in (picture, vector) if each.exists()]


def lettered(figure):
    """Put (a), (b), ... before the titles of panels, as a text that cites one of them needs; in order of drawing."""
    from matplotlib.text import Text

    panels = panels_of(figure)
    if not 1 < len(panels) <= len(ascii_lowercase):
        return
    for letter, axes in zip(ascii_lowercase, panels, strict=False):
        titles = {axes.get_title(loc=where) for where in ("left", "center", "right")} - {""}
        said = [each for each in axes.get_children() if isinstance(each, Text) and each.get_text() in titles]
        if said:
            said[0].set_text(f"({letter}) {said[0].get_text()}")
        else:
            axes.set_title(f"({letter})", loc="left")


def raised(figure):
    """Set powers such as 128^3 as superscripts, wherever no formula is."""
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        if "$" not in text.get_text():
            text.set_text(POWER.sub(lambda found: found[1].translate(RAISED), text.get_text()))


def panels_of(figure):
    """Axes that show something of their own: no bars of colour, insets, and second axes of a panel."""
    inside = {inset for axes in figure.axes for inset in axes.child_axes}
    found: dict = {}
    for axes in figure.axes:
        if axes.get_visible() and axes.get_label() != "<colorbar>" and axes not in inside:
            found.setdefault(axes.get_subplotspec() or axes, axes)
    return list(found.values())


def pixels_for_many(figure):
    """Have artists of very many parts drawn as pixels in vector formats; those of few stay lines and letters."""
    from matplotlib.collections import Collection
    from matplotlib.lines import Line2D

    for artist in figure.findobj(Collection):
        if max(len(artist.get_offsets()), sum(len(path.vertices) for path in artist.get_paths())) > MANY:
            artist.set_rasterized(True)
    for artist in figure.findobj(Line2D):
        if len(artist.get_xdata()) > MANY:
            artist.set_rasterized(True)


def embedded(path):
    """A picture file as the address of itself, for a page that needs no other file."""
    from PIL import Image

    with Image.open(path) as picture:
        small = picture.convert("RGB")
        if small.width > WIDEST:
            small = small.resize((WIDEST, round(small.height * WIDEST / small.width)), Image.Resampling.LANCZOS)
        buffer = io.BytesIO()
        small.quantize(COLOURS, dither=Image.Dither.NONE).save(buffer, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()
