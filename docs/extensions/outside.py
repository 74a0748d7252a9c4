"""Links of the manual to pages that are not part of it: the file itself is handed out, as it lies in the repository."""

import re
from pathlib import Path

LINK = re.compile(r"\[([^\]]+)\]\(((?:\.\./)+[\w./-]+\.md)(?:#[\w-]+)?\)")


def setup(app):
    """Look at every page as it is read.

    Parameters
    ----------
    app : sphinx.application.Sphinx
    """
    app.connect("source-read", _handed_out)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _handed_out(app, name, source):
    page = Path(app.env.doc2path(name))

    def link(match):
        inside = (page.parent / match[2]).resolve().is_relative_to(app.srcdir)
        return match[0] if inside else f"{{download}}`{match[1]} <{match[2]}>`"

    source[0] = LINK.sub(link, source[0])
