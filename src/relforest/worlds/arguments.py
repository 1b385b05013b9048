"""Checks of the arguments that all worlds take: actions, seeds, reset options, render modes, generators."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any, Final, TypeAlias

import numpy as np

from relforest.support.errors import InputError
from relforest.support.options import at_least

Check: TypeAlias = Callable[[object], Any]

RENDER_MODES: Final = ("rgb_array",)
"""The modes that worlds implement themselves; `viewing` adds those of Gymnasium's wrappers."""


def checked_action(action: object, n_actions: int, meaning: str = "", name: str = "action") -> int:
    """Return a member of a ``Discrete`` space as a plain integer.

    Gymnasium's space contains Python integers (a bool is one), NumPy integers, and integer arrays without
    dimensions. Messages tell what the numbers mean, and the name of the action.

    Raises
    ------
    InputError
        If it is not an integer from 0 to ``n_actions - 1``.
    """
    try:
        index = operator.index(action)  # type: ignore[arg-type]
    except TypeError:
        index = -1
    if 0 <= index < n_actions:
        return index
    shape = getattr(action, "shape", ())
    found = f"an array of shape {shape}: pass one of its elements" if shape else repr(action)
    explained = f" ({meaning})" if meaning else ""
    raise InputError(f"{name} must be an integer from 0 to {n_actions - 1}{explained}, got {found}")


def checked_seed(seed: object) -> int | None:
    """Return the seed of a reset as a plain integer, or None.

    Raises
    ------
    InputError
        If it is neither None nor an integer of at least 0.
    """
    return None if seed is None else at_least("seed", seed, 0)


def checked_reset_options(options: object, known: Mapping[str, Check] | None) -> dict[str, Any]:
    """Return the options of a reset by name; none for None.

    Raises
    ------
    InputError
        If options are neither a mapping nor None, a name is not ``known``, or its function does not accept
        the value. Without ``known``, all are accepted.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise InputError(f"options of reset() must be a dictionary or None, got {options!r}")
    if known is None:
        return dict(options)
    for name in options:
        if name not in known:
            remedy = f"choose from {', '.join(map(repr, known))}" if known else "this world takes none"
            raise InputError(f"{name!r} is not an option of reset(): {remedy}")
    return {name: known[name](value) for name, value in options.items()}


def checked_render_mode(render_mode: object) -> str | None:
    """Return a mode that worlds implement themselves, or None.

    Raises
    ------
    InputError
        If it is neither None nor one of `RENDER_MODES`.
    """
    if render_mode is None or (isinstance(render_mode, str) and render_mode in RENDER_MODES):
        return render_mode
    raise InputError(
        'render_mode must be None or "rgb_array" (gymnasium.make also takes "human" and "rgb_array_list"), '
        f"got {render_mode!r}"
    )


def entries(values: object) -> tuple[Any, ...]:
    """Return the entries of a pair or triple given by a user; () if it is not a sequence."""
    try:
        return tuple(values)  # type: ignore[arg-type]
    except TypeError:
        return ()


def checked_generator(rng: object) -> np.random.Generator:
    """Return a generator of random numbers.

    Raises
    ------
    InputError
        If it is not a `numpy.random.Generator`.
    """
    if not isinstance(rng, np.random.Generator):
        raise InputError(f"rng must be a numpy Generator, such as numpy.random.default_rng(0), got {rng!r}")
    return rng
