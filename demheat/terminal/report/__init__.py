"""One page of HTML about a scene that needs nothing else: the scene to turn, fields, answers, what was assumed."""

from demheat.terminal.report.page import Content, page
from demheat.terminal.report.volume import kinds_of, values_of

__all__ = ["Content", "kinds_of", "page", "values_of"]
