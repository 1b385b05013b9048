"""Why a model predicts what it predicts for one scene, and what would turn it.

`moves` puts objects elsewhere and finds the smallest move that turns a class, `decision_map` what is
predicted while one object is anywhere, `explanation` joins both with the questions that decided, and `page`
shows it.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
