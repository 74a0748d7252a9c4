"""Drawn scenes: the same for a seed, and one is found where the first draw has no room."""

import pytest

from studies.common import drawn


@pytest.mark.parametrize("kind", drawn.KINDS)
def test_a_seed_is_a_scene(kind):
    assert drawn.scene_of(kind, 3) == drawn.scene_of(kind, 3) != drawn.scene_of(kind, 4)


def test_a_draw_without_room_is_drawn_anew():
    assert len(drawn.scene_of("neutral spheres", 221).inclusions) >= 2
