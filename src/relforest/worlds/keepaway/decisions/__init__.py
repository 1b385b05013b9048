"""What a keeper with the ball decides on, as learners see it, and policies that decide.

`scene` holds the objects and the actions of relational learners, `variables` the numbers of the benchmark,
and `policies` those to compare with.
"""

from __future__ import annotations
