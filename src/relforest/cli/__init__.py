"""The command line: one module per command, which defines its options, calls the library and prints.

`app.main` chooses the command. Results go to standard output, everything else to standard error.
"""

from __future__ import annotations
