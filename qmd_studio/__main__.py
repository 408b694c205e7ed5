"""`python -m qmd_studio` opens the studio."""

import sys

from qmd_studio.ui.app import main

if __name__ == "__main__":
    sys.exit(main())
