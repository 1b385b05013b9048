"""``python -m relforest`` is the command ``relforest``."""

from __future__ import annotations

import sys

from relforest.cli.app import main

if __name__ == "__main__":
    sys.exit(main())
