"""Which searches there are, and how many processor seconds each may take."""

from studies.common.searches.in_time import IN_TIME
from studies.common.searches.scenes import FOR_LAWS, HELD_BACK, ONLY_SPHERES, SCENES
from studies.common.searches.ways import ASKED, ASKED_S, WAYS

# Processor seconds of a search: on any scene, on one that is there for the laws alone, of a body that warms up.
USUAL, SHORT, IN_TIME_S = 20.0, 8.0, 30.0
# On scenes that take less, or more; of surfaces a few values tell laws too little.
OTHERWISE = {
    5.0: ("laminate",),
    8.0: ("image",),
    12.0: ("thin shell",),
    30.0: ("half", "ellipsoids at 50", "joined at 0.1", "30 of 1 to 4"),
    40.0: ("half at 100", "primitive at 20"),
    60.0: ("gyroid",),
    80.0: ("3000 spheres",),
    110.0: ("1000 spheres",),
    190.0: ("5000 spheres",),
}
# Of elements where one mesh takes long: as much as three of them, since fewer tell nothing.
MESHED = {
    25.0: ("fibre at 50", "infinite"),
    40.0: ("10 pores",),
    45.0: ("joined at 0.1", "box of 1:3:1"),
    55.0: ("polydisperse", "unions", "resistance"),
    60.0: ("30 at 0.001", "box of 1:1:4", "ellipsoids at 50", "30 of 1 to 4"),
    100.0: ("unequal, f = .5", "ellipsoids"),
    120.0: ("83 spheres",),
}
# Ways that laws are fitted to.
LAWS = ("dem", "fem", "fft-loose", "multipole-loose")
# Of a quick run, beside the others.
QUICK_SECONDS, QUICK_SCENES, QUICK_WAYS = (
    4.0,
    ("third", "83 spheres", "fibre at 50"),
    ("dem", "fem", "fft", "fft-loose"),
)
# Where a way says nothing, or nothing else than another: layers are exact by any, an image has no rules, perfect
# conductors few methods.
RULES = ("fem-p1", "fft-laminate", "fft-links", "fft-em")
# Part of the seconds of others that they have: where one of them was its method's cheapest it was to coarse accuracies.
LESS = 0.5
LEFT_OUT = {
    "laminate": RULES,
    "image": ("fft", "fft-loose", *RULES),
    "infinite": RULES,
    # Round.
    "ball": ("fem-bricks-time",),
    "beam": ("fem-bricks-time",),
    "gyroid": ("fft-em",),
    # Elements around a thousand spheres take more memory than there is; laminate voxels are the FFT's own there.
    "1000 spheres": ("fem", "fem-p1", "fft-em", "fft-laminate", "dem-limit"),
    "3000 spheres": ("fem",),
    "5000 spheres": ("fem", *RULES),
}
# Of one sphere in a cube a program of others has what it is given there.
PEERS = ("third", "third at 0.01", "third at 1000", "half", "half at 100")
PAPER = (*PEERS, "83 spheres", "polydisperse")
# Searched beside the record (`second`) wherever it has the way behind the colon, but where it has them itself.
SECOND = {"dem-loose": "dem", "fem-loose": "fem", "dem-limit": "dem"}
DEM_LIMIT = ("half", "half at 100", "83 spheres", "1000 spheres", "unequal, f = .5", "infinite")


def all_cases():
    """Short searches of few scenes, and all others."""
    for scene in QUICK_SCENES:
        yield from (_case(scene, way, QUICK_SECONDS) for way in QUICK_WAYS)
    for scene in SCENES:
        yield from (_case(scene, way, _seconds(scene, way)) for way, how in WAYS.items() if _fits(way, how, scene))
    for scene in IN_TIME:
        yield from (_case(scene, way, IN_TIME_S) for way, how in WAYS.items() if _fits(way, how, scene))
    # Asked for an accuracy, which ends with a search's seconds in no case.
    yield from ({"scene": scene, "way": ASKED, "seconds": 3 * ASKED_S, "method": ASKED} for scene in HELD_BACK)
    for scene in FOR_LAWS:
        yield from (_case(scene, way, _seconds(scene, way)) for way in LAWS if _fits(way, WAYS[way], scene))


def second_cases():
    """Searches beside the record by ways that it has on few scenes, or on none."""
    known = [(case["scene"], case["way"]) for case in all_cases()]
    for scene in SCENES:
        ways = [way for way, usual in SECOND.items() if (scene, usual) in known]
        yield from (_case(scene, way, _seconds(scene, way)) for way in ways if (scene, way) not in known)


def _seconds(scene, way):
    usual = _of(OTHERWISE, scene, SHORT if scene in FOR_LAWS else USUAL)
    if WAYS[way].knob == "size" and not WAYS[way].peer:
        usual = _of(MESHED, scene, usual)
    return usual * (LESS if way in RULES else 1.0)


def _of(seconds, scene, usual):
    """Seconds of a scene where it is named, else the usual ones."""
    return next((each for each, scenes in seconds.items() if scene in scenes), usual)


def _fits(way, how, scene):
    """Whether a way says anything of a scene, and the record has it there."""
    if how.marches is not (scene in IN_TIME):
        return False
    if (how.spheres and scene not in ONLY_SPHERES) or (how.knob == "parts" and scene != "image"):
        return False
    if (how.peer and scene not in PEERS) or (way == "dem-paper" and scene not in PAPER):
        return False
    return way not in LEFT_OUT.get(scene, ()) and (way not in SECOND or (way == "dem-limit" and scene in DEM_LIMIT))


def _case(scene, way, seconds):
    return {"scene": scene, "way": way, "seconds": seconds, "method": WAYS[way].method}


def foreseen():
    """Minutes that all searches take at most, on two processors of which each search uses about one and a half."""
    return sum(case["seconds"] for case in all_cases()) / 60
