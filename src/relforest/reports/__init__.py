"""Pictures and texts about what was learned; nothing here learns or decides.

`tree_figure` draws a tree with its decision volumes, `reward_figure` and `leaves_figure` draw learning
curves, `corridor_figure` draws the action values of a one-dimensional world, and `run_report` describes a
run. `save_figure` writes any figure as PNG or SVG, always with the same bytes; `style` defines the style.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
