"""Damage: inclusions that have come off, links that are gone, insulated cracks."""

from typing import TYPE_CHECKING

from demheat.runtime.lazy import lazy_names

if TYPE_CHECKING:
    from demheat.damage.cracks import Disc, Rectangle, cracked
    from demheat.damage.inclusions import debonded
    from demheat.damage.links import without_links
    from demheat.damage.solver import solve

__all__ = ["Disc", "Rectangle", "cracked", "debonded", "solve", "without_links"]

HOMES = {
    "demheat.damage.cracks": ("Disc", "Rectangle", "cracked"),
    "demheat.damage.inclusions": ("debonded",),
    "demheat.damage.links": ("without_links",),
    "demheat.damage.solver": ("solve",),
}
# What is heavy loads with the first use; type checkers do not see it, see `lazy_names`.
if not TYPE_CHECKING:
    __getattr__, __dir__ = lazy_names(__name__, HOMES)
