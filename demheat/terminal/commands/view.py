"""`demheat view`: a picture of a scene, three slices of its phases, and of its field by a method."""

import sys

from demheat.runtime.paths import check_output, made_folder, replaced
from demheat.terminal.commands.answers import answered
from demheat.terminal.commands.compare import OUT
from demheat.terminal.commands.knobs import asked
from demheat.terminal.commands.words import typed


def run(file, options) -> int:
    """Draw; the exit status."""
    if options.knob and not options.methods:
        raise ValueError(f"--knob {options.knob[0]}: no method is named; must be with --method")
    # Methods of the file are solved only if they are named: a picture of the scene costs nothing.
    wanted = asked(file, options.methods, options.knob, default=()) if options.methods else []
    folder = typed("--out", options.out or OUT, check_output)
    _saved(file.scene.plot(), folder / f"{file.path.stem}-scene.png")
    worst = 0
    for each in wanted:
        found = answered(file.scene, each, interval=False)
        for note in found.notes:
            print(f"demheat: {each.method.name}: {note}", file=sys.stderr)
        if found.field is None:
            worst = max(worst, 2 if found.status == "invalid" else 1)
        else:
            _saved(found.field.plot(), folder / f"{file.path.stem}-{each.method.name}.png")
    return worst


def _saved(figure, path):
    made_folder(path.parent)
    with replaced(path) as part:
        figure.savefig(part, dpi=120)
    print(f"picture {path}")
