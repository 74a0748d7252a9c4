"""Who may import whom: the rooms of the house, and the one home of each library."""

from imported import HOMES, MODULES, OURS, below, imports_of
from rooms import FRONTS, LAYERS, ROOMS


def room_of(name):
    """The room of a module, its longest prefix among them."""
    return max((key for key in LAYERS if below(name, key)), key=len)


def refused(name, targets):
    """Of what a module imports that which it may not, as sentences."""
    own = (".".join(name.split(".")[:2]),) if room_of(name) == "studies" and name != "studies" else ()
    allowed = () if name.endswith("kernels") else (*LAYERS[room_of(name)], *own)
    wrong = []
    for target in sorted(targets):
        library = target.split(".")[0]
        if library in OURS:
            fits = any(below(target, other) for other in allowed)
            beside = name.endswith("kernels") and (target.endswith("kernels") or target == "demheat.runtime.compiled")
            # Kernels share helpers among themselves and know nothing else.
            if not (fits or beside):
                wrong.append(f"{name} imports {target}")
        elif library in HOMES:
            homes = HOMES[library]
            if not any(name.endswith(home[1:]) if home[0] == "*" else below(name, home) for home in homes):
                wrong.append(f"{name} imports {library}, whose home is {' and '.join(homes)}")
    return wrong


def test_layers():
    assert [said for name in MODULES for said in refused(name, imports_of(name))] == []


def test_rooms_stand_on_rooms_before_them():
    prefixes = list(LAYERS)
    for number, prefix in enumerate(prefixes):
        # Members of a room stand beside each other; what circles there are, is asked elsewhere.
        beside = next((own for own, _ in ROOMS.values() if prefix in own), ())
        upward = [each for each in LAYERS[prefix] if room_of(each) not in (*prefixes[: number + 1], *beside)]
        assert upward == [], f"{prefix} stands on rooms after it"


def test_every_module_has_a_room_of_its_own():
    homeless = [name for name in MODULES if room_of(name) in FRONTS and name not in FRONTS]
    assert not homeless, f"tests/rooms.py or tests/rooms_beside.py wants a line of {', '.join(homeless)}"
    empty = [room for room in LAYERS if not any(below(name, room) for name in MODULES)]
    assert not empty, f"rooms of modules that are not there: {', '.join(empty)}"
