"""Pictures and texts about what was learned; nothing here learns or decides.

`tree_figure` draws a tree with its decision volumes, `reward_figure` and `leaves_figure` show the progress of
learning, `corridor_figure` shows the action values of a one-dimensional world, and `run_report` describes a
run in words. `save_figure` writes any figure as PNG or SVG, always with the same bytes; `style` is the common
look.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
