"""Small tables for notebooks."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape


def table_of(rows: Mapping[str, object]) -> str:
    """A table of two columns as HTML; what is in it is text, whatever it looks like."""
    cells = (f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows.items())
    return f"<table>{''.join(cells)}</table>"
