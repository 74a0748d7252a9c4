"""`python -m demheat`, as the command `demheat`."""

import sys

from demheat.commands import main

if __name__ == "__main__":
    sys.exit(main())
