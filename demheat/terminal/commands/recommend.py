"""`demheat recommend`: which method gets to an accuracy at least cost, and what each would cost."""

from demheat.cheapest import recommend
from demheat.terminal.commands.effective import wanted_accuracy
from demheat.terminal.commands.words import scene_line


def run(file, options) -> int:
    """Print what is recommended; the exit status: 1 if nothing gets there."""
    accuracy = wanted_accuracy(file, options)
    found = recommend(file.scene, accuracy)
    print(f"{file.path}: {scene_line(file.scene)}\n")
    print(f"{found.method or 'no method for sure'}, to an accuracy of {accuracy:g}\n{found.why}")
    return 0 if found.method else 1
