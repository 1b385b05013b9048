"""Render modes that Gymnasium's wrappers add to every world: a window, and lists of pictures."""

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
    """A window is asked for and cannot be opened; the message says what is missing."""


def viewable(make: Maker) -> Maker:
    """Return what makes a world for ``gymnasium.make`` in all render modes.

    Parameters
    ----------
    make : callable
        Makes the world; ``render_mode`` is its first parameter, ``"rgb_array"`` or None.

    Returns
    -------
    callable
        The same with ``"human"``, a window that shows each state (Gymnasium's `HumanRendering`), and
        ``"rgb_array_list"``, a list of all pictures since the last call (its `RenderCollection`).

    Notes
    -----
    Gymnasium would add the wrappers itself, but only to classes, and finds out that it cannot open a window
    when the first episode begins.
    """

    # Annotated as little as possible: the world checks the mode.
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
        raise NoWindowError(
            f'render_mode="human" needs a screen ({error}): log in with one, {remedy}'
        ) from error
