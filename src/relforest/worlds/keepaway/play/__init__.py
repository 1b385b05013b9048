"""Games as they are played: from decision to decision, and from episode to episode.

`games` begins some and `advance` continues one until a keeper must decide, the only loop over cycles. `batch`
plays many for environments; `durations` plays and counts (`events`) episodes without an environment.
"""

from __future__ import annotations
