"""The command line: one file per command, which says what it accepts, calls the library and prints.

`app.main` chooses the command. Results go to standard output, everything else to standard error.
"""

from __future__ import annotations
