"""The server: what is true, how it moves, and what the referee says.

Read `layout`, the arrays of a game, and `options`; then `physics` and `referee`, with the random numbers of
`randomness`. `rounding` is how the server tells what players see; `bounds` checks recorded steps.
"""

from __future__ import annotations
