"""Render modes that Gymnasium's wrappers add to every world: a window and lists of pictures."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeAlias

import gymnasium
from gymnasium.error import DependencyNotInstalled
from gymnasium.wrappers import HumanRendering, RenderCollection

from relforest.support.errors import InputError

Maker: TypeAlias = Callable[..., gymnasium.Env[Any, Any]]


class NoWindowError(InputError, DependencyNotInstalled):
    """A window cannot be opened; the message names what is missing."""


def viewable(make: Maker) -> Maker:
    """Return a constructor of a world that accepts all render modes, for ``gymnasium.make``.

    Parameters
    ----------
    make : callable
        Constructor of the world. Its first parameter is ``render_mode``, ``"rgb_array"`` or None.

    Returns
    -------
    callable
        It also accepts ``"human"``, which shows each state in a window (Gymnasium's `HumanRendering`), and
        ``"rgb_array_list"``, which collects all pictures since the last call (its `RenderCollection`).

    Notes
    -----
    Gymnasium adds these wrappers by itself, but only to classes, with a warning, and without checking in
    advance that a window can be opened.
    """

    # The world checks the type of the mode.
    def made(render_mode: Any = None, **options: Any) -> gymnasium.Env[Any, Any]:  # noqa: ANN401
        match render_mode:
            case "human":
                check_window()
                return HumanRendering(make("rgb_array", **options))
            case "rgb_array_list":
                return RenderCollection(make("rgb_array", **options))
        return make(render_mode, **options)

    return made


def check_window() -> None:
    """Check that pygame can open a window.

    Raises
    ------
    NoWindowError
        If it cannot.
    """
    remedy = 'or choose render_mode="rgb_array"'
    try:
        pygame = import_module("pygame")
    except ImportError as error:
        raise NoWindowError(f'render_mode="human" needs pygame: pip install pygame, {remedy}') from error
    try:
        pygame.display.init()
    except pygame.error as error:
        raise NoWindowError(f'render_mode="human" needs a display ({error}): start one, {remedy}') from error
