"""The commands `demheat init | solve | compare | effective | recommend | view | report scene.toml`, and `judge x.json`.

Exit status: 0; 1 if a method that was asked for refused or failed; 2 for bad input, which one line on standard error
names; 130 if interrupted; 141, without a word, if nobody reads what is printed.
"""

import sys
from importlib import import_module

from demheat.io.scenes import read_file
from demheat.terminal.commands.options import parser
from demheat.terminal.ends import BAD, INTERRUPTED, error_line, finished, of_output
from demheat.version import __version__

DONE, WITHOUT = 0, 1


def main(words=None) -> int:
    """Do what a command line says.

    Parameters
    ----------
    words : sequence of str, optional
        Default: those of the process.

    Returns
    -------
    int
        Exit status.

    Examples
    --------
    >>> import tempfile
    >>> from demheat import gallery
    >>> from demheat.io import scenes
    >>> from demheat.terminal.commands import main
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scenes.write(gallery.laminate(), f"{folder}/scene.toml")
    ...     main(["solve", f"{folder}/scene.toml", "--method", "exact", "--no-interval"])
    /...scene.toml: box of 100 x 100 x 100 mm, 2 layers, 33 to 165 W/(m K), walls y-, y+
    <BLANKLINE>
    exact
      conductivity  55 W/(m K)
    ...
    0
    """
    for stream in (sys.stdout, sys.stderr):
        # A name may hold a letter that a terminal of another alphabet has not: that must not cost the run.
        getattr(stream, "reconfigure", lambda **knobs: None)(errors="backslashreplace")
    return finished(lambda: _done(words), "demheat")


def _done(words):
    try:
        options = parser(__version__).parse_args(words)
        command = import_module(f"demheat.terminal.commands.{options.command}")
        if options.command in ("init", "judge"):
            return command.run(options)
        return command.run(read_file(options.scene), options)
    except (NotImplementedError, RuntimeError, MemoryError, ImportError, TimeoutError) as error:
        return _said(error, WITHOUT)
    except (ValueError, OSError) as error:
        if of_output(error):
            raise
        return _said(error, BAD)
    except KeyboardInterrupt:
        print(
            "\ndemheat: interrupted; rows of `compare` that are done are kept, the same command goes on",
            file=sys.stderr,
        )
        return INTERRUPTED


def _said(error, status):
    print(f"demheat: {error_line(error)}", file=sys.stderr)
    return status
