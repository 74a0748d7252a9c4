"""Rooms above the package: the benchmark and studies."""

ABOVE = {
    # Scenes with known answers: what reads them knows the nouns, what made them the witnesses.
    "benchmark.parts": ("demheat.scene", "demheat.io"),
    "benchmark.schema": (),
    "benchmark": ("demheat.scene", "demheat.io.known"),
    "benchmark.recipes": (
        "demheat.scene",
        "demheat.addition",
        "demheat.io.known",
        "demheat.gallery",
        "demheat.referee",
        "references",
        "benchmark",
        "benchmark.recipes",
    ),
    "benchmark.make": ("benchmark", "demheat.io.known"),
    "studies.harness": ("demheat", "references", "studies.harness"),
    # Headlines are among what a change is shown by.
    "studies.contents": (),
    "studies.harness.accept": ("demheat.runtime", "studies.contents", "studies.harness"),
    "studies.common": ("demheat", "references", "studies.harness", "studies.common"),
    # And every study itself, if it is a folder.
    "studies": ("demheat", "references", "benchmark", "studies.harness", "studies.common"),
    "studies.__main__": ("demheat.runtime", "demheat.terminal.ends", "studies"),
}
