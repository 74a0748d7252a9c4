"""`demheat solve`: one method or some on a scene, each with its conductivity, interval and cost."""

import sys
import time

from demheat.io.fields import field_target
from demheat.runtime.deadline import budget
from demheat.runtime.paths import check_output, made_folder, replaced
from demheat.terminal.commands.answers import answered
from demheat.terminal.commands.knobs import asked
from demheat.terminal.commands.words import costs, interval, scene_line, time_was_over, typed


def run(file, options) -> int:
    """Solve and print; the exit status."""
    wanted = asked(file, options.methods, options.knob, default=("dem",))
    if options.write and len(wanted) > 1:
        raise ValueError(f"--write {options.write}: of one method, and {len(wanted)} are asked for; must be with --out")
    for each in wanted if options.write else ():
        if each.method.call == "estimate":
            raise NotImplementedError(f"--write {options.write}: {each.method.name} is a formula and has no field")
        typed("--write", options.write, field_target)
    folder = typed("--out", options.out, check_output) if options.out else None
    print(f"{file.path}: {scene_line(file.scene)}")
    worst, late, begun = 0, [], time.monotonic()
    for each in wanted:
        with budget(options.seconds, begun=begun):
            found = answered(file.scene, each, interval=not options.no_interval)
        late += [each] if found.cut else []
        worst = max(worst, _shown(each, found))
        if folder and found.field is not None:
            _stored(folder, each.method.name, found.field)
        if options.write and found.field is not None:
            found.field.write(options.write)
            print(f"  written       {options.write}", flush=True)
    if said := time_was_over(options.seconds, late, file.scene):
        print(f"demheat: {said}", file=sys.stderr)
    return worst


def _shown(each, found):
    """Print an answer; the exit status that it asks for."""
    for note in found.notes:
        print(f"demheat: {each.method.name}: {note}", file=sys.stderr)
    if found.status != "ok":
        return 2 if found.status == "invalid" else 1
    print(f"\n{each.title}")
    print(f"  conductivity  {interval(found)}")
    for name, heat in (found.field.wall_heat if found.field else {}).items():
        print(f"  heat at {name}    {heat:.6g} W into the body")
    print(f"  cost          {costs(found)}", flush=True)
    return 0


def _stored(folder, name, field):
    path = made_folder(folder) / f"{name}.npz"
    field.write(path)
    print(f"  written       {path}")
    with replaced(path.with_suffix(".png")) as part:
        field.plot().savefig(part, dpi=120)
    print(f"  picture       {path.with_suffix('.png')}", flush=True)
