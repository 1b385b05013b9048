"""The scripted players of the benchmark: what they see, remember and do.

Read `views` and `memory`, then `roles`: a keeper goes for the ball (`interception`, `close_interception`),
holds or passes it (`kicks`), or gets open (`positioning`, `arrival`); all plan with `motion` and `commands`.
"""

from __future__ import annotations
