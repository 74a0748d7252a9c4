"""`python -m demheat`, as the command `demheat`."""

import sys

from demheat.terminal.commands import main

if __name__ == "__main__":
    sys.exit(main())
