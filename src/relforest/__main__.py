"""The command ``relforest``, also as ``python -m relforest``."""

from __future__ import annotations

import sys


def main() -> int:
    """Run the command line; see `relforest.cli.app.main`."""
    try:
        from relforest.cli import app  # noqa: PLC0415 - an interrupt may come this early
    except KeyboardInterrupt:
        return 130
    return app.main()


if __name__ == "__main__":
    sys.exit(main())
