"""Keepaway: keepers pass a ball among themselves, takers try to get it; RoboCup's benchmark in one process.

The game of Stone et al. (2006), with the motion of the RoboCup 2-D server and the scripted players of the
benchmark, as compiled kernels (Palmer (2015), section 7.5). Create it with
``gymnasium.make("relforest/Keepaway-v0")``; `episode_durations` plays many episodes without an environment.

Start with ``server.layout``, the arrays of a game. `server` moves them, `players` choose commands,
`decisions` are what a keeper with the ball sees and does, and `play` combines all in its
one loop, ``play.advance``.
`env`, `vector`, `parallel` and `wrapper` are the environments; `frames` are what there is to see.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
