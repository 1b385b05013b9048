"""Scenes labelled by a relational concept that is known exactly, for studies of concept recovery.

All generators draw candidate scenes and keep them until half of the scenes asked for are positive. The label
of a scene is the concept evaluated on its attribute values, never a hidden variable.

Letters: m scenes, n the largest number of objects of one of them.
"""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.balance import Candidates, balanced, is_object, to_scenes
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.options import at_least

NumberOfObjects: TypeAlias = int | tuple[int, int]

_PLACED_PAIR: Final = Schema((Attribute("location", 2),), parameters=("A", "B"))
_PLACED_COLORS: Final = Schema((Attribute("location", 2), Attribute("color", 3)))

_BETWEEN_WIDTH: Final = 10.0
_BETWEEN_ALONG: Final = (0.2, 0.8)
_BETWEEN_ACROSS: Final = 0.15

_FIGURE41_HALF_WIDTH: Final = 5.0
_FIGURE41_RED_SHARE: Final = 0.5
_FIGURE41_AT_ORIGIN: Final = 2.0
_FIGURE41_NEAR: Final = 10.0

_HUES: Final = np.array(
    [
        [0.90, 0.15, 0.10],  # red
        [0.15, 0.70, 0.20],  # green
        [0.10, 0.20, 0.80],  # blue
        [0.90, 0.40, 0.10],  # orange
        [0.40, 0.90, 0.10],  # lime
        [0.80, 0.80, 0.80],  # grey
        [0.90, 0.85, 0.10],  # yellow
    ]
)
_YELLOW_SHARE: Final = 0.1
_DIMMEST: Final = 0.4
_COLOR_NOISE: Final = 0.03


def between_scenes(
    rng: np.random.Generator,
    n_scenes: int = 500,
    *,
    n_objects: NumberOfObjects = (5, 8),
    n_distractors: int = 0,
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes that are positive if a third object lies between the two arguments.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    n_scenes : int
        Number of scenes, at least 2; ``n_scenes // 2`` of them are positive.
    n_objects : int or pair of int
        Number of objects of a scene, the arguments included, or its smallest and largest value (uniform); at
        least 3.
    n_distractors : int
        Number of further objects of every scene; none of them ever lies between the arguments.

    Returns
    -------
    scenes : Scenes
        Attribute ``location`` (2-D), arguments ``A`` and ``B``.
    labels : (n_scenes,) bool

    Raises
    ------
    InputError
        If a number is out of range.

    Notes
    -----
    Locations are uniform in [0, 10]^2 (distractors: in the part of it that is not between). The label: there
    is a C with .2 < u < .8 and abs(v) < .15, where u + iv = (C - A) / (B - A) is the scaled reframe of Palmer
    (2015), section 4.3.
    """
    n_distractors = at_least("n_distractors", n_distractors, 0)
    lowest, highest = _range_of_objects(n_objects, fewest=3)

    def draw(n_candidates: int) -> Candidates:
        counts = rng.integers(lowest, highest + 1, size=n_candidates)
        location = rng.uniform(0, _BETWEEN_WIDTH, size=(n_candidates, highest + n_distractors, 2))
        _clear_distractors(rng, location, counts)
        labels = np.any(_is_between(location) & is_object(counts, location.shape[1]), axis=1)
        return Candidates(location, counts + n_distractors, labels)

    return to_scenes(_PLACED_PAIR, balanced(rng, n_scenes, draw))


def figure41_scenes(
    rng: np.random.Generator, n_scenes: int = 500, *, n_objects: NumberOfObjects = (5, 8)
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes labelled by the disjunctive concept of Figure 4.1.

    Positive: there is a red object at the origin, or an object that is not red and has another one not near
    it.

    Parameters
    ----------
    rng, n_scenes, n_objects
        As in `between_scenes`, but a scene may have a single object.

    Returns
    -------
    scenes : Scenes
        Attributes ``location`` (2-D) and ``color`` (RGB, 0 to 1), no arguments.
    labels : (n_scenes,) bool

    Raises
    ------
    InputError
        If a number is out of range, or scenes with this many objects are hardly ever negative.

    Notes
    -----
    Locations are uniform in [-5, 5]^2. Half of the objects are red, a quarter green, a quarter blue; the
    channel of that name is uniform in [.7, 1], the other two in [0, .3]. Red: the red channel above .5 and
    the others below. At the origin: within 2 of (0, 0). Near: at most 10 apart. With 5 to 8 objects and
    before balancing, the first disjunct holds in .34 of the scenes, the second in .24, either in .51.

    References
    ----------
    Palmer (2015), Figure 4.1.
    """
    lowest, highest = _range_of_objects(n_objects, fewest=1)

    def draw(n_candidates: int) -> Candidates:
        counts = rng.integers(lowest, highest + 1, size=n_candidates)
        shape = (n_candidates, highest)
        location = rng.uniform(-_FIGURE41_HALF_WIDTH, _FIGURE41_HALF_WIDTH, size=(*shape, 2))
        others = (1 - _FIGURE41_RED_SHARE) / 2
        channel = rng.choice(3, size=shape, p=(_FIGURE41_RED_SHARE, others, others))
        color = rng.uniform(0, 0.3, size=(*shape, 3)) + 0.7 * (np.arange(3) == channel[..., np.newaxis])
        red = (color[..., 0] > 0.5) & (color[..., 1] < 0.5) & (color[..., 2] < 0.5)
        present = is_object(counts, highest)
        at_origin = np.linalg.norm(location, axis=-1) <= _FIGURE41_AT_ORIGIN
        gaps = np.linalg.norm(location[:, :, np.newaxis] - location[:, np.newaxis], axis=-1)
        has_far = ((gaps > _FIGURE41_NEAR) & present[:, np.newaxis]).any(axis=2)
        labels = (present & ((red & at_origin) | (~red & has_far))).any(axis=1)
        return Candidates(np.concatenate([location, color], axis=-1), counts, labels)

    return to_scenes(_PLACED_COLORS, balanced(rng, n_scenes, draw))


def yellow_scenes(
    rng: np.random.Generator, n_scenes: int = 500, *, n_objects: NumberOfObjects = (5, 8)
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes that are positive if one of the objects is yellow, a covariant concept in RGB.

    Parameters, scenes and errors are those of `figure41_scenes`; locations are irrelevant.

    Notes
    -----
    A color is a hue times a brightness uniform in [.4, 1], plus noise uniform in [-.03, .03] in each
    channel, cut to [0, 1]. The hues are red (.9, .15, .1), green (.15, .7, .2), blue (.1, .2, .8), orange
    (.9, .4, .1), lime (.4, .9, .1) and grey (.8, .8, .8), .15 each, and yellow (.9, .85, .1), .1. The label:
    there is an object with abs(R - G) < .12, R + G > .5 and B < .2. Brightness stretches every hue along its
    own direction, so that a ball around the yellow ones also holds dim orange and lime: only a volume that
    follows the covariance separates them. Locations are uniform in [0, 10]^2.
    """
    lowest, highest = _range_of_objects(n_objects, fewest=1)
    shares = np.full(len(_HUES), (1 - _YELLOW_SHARE) / (len(_HUES) - 1))
    shares[-1] = _YELLOW_SHARE

    def draw(n_candidates: int) -> Candidates:
        counts = rng.integers(lowest, highest + 1, size=n_candidates)
        shape = (n_candidates, highest)
        location = rng.uniform(0, 10, size=(*shape, 2))
        hue = _HUES[rng.choice(len(_HUES), size=shape, p=shares)]
        brightness = rng.uniform(_DIMMEST, 1, size=(*shape, 1))
        noise = rng.uniform(-_COLOR_NOISE, _COLOR_NOISE, size=(*shape, 3))
        color = np.clip(brightness * hue + noise, 0, 1)
        red, green, blue = np.moveaxis(color, -1, 0)
        yellow = (np.abs(red - green) < 0.12) & (red + green > 0.5) & (blue < 0.2)
        labels = (yellow & is_object(counts, highest)).any(axis=1)
        return Candidates(np.concatenate([location, color], axis=-1), counts, labels)

    return to_scenes(_PLACED_COLORS, balanced(rng, n_scenes, draw))


def _is_between(location: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (m, n) bool: which objects lie between the first two of their scene; never those two."""
    position = location[..., 0] + 1j * location[..., 1]
    origin, end = position[:, :1], position[:, 1:2]
    framed = (position - origin) / (end - origin)
    low, high = _BETWEEN_ALONG
    between: NDArray[np.bool_] = (
        (framed.real > low) & (framed.real < high) & (np.abs(framed.imag) < _BETWEEN_ACROSS)
    )
    return between


def _clear_distractors(
    rng: np.random.Generator, location: NDArray[np.float64], counts: NDArray[np.int64]
) -> None:
    """Move the objects behind the first ``counts`` of each scene, in place, until none lies between."""
    distractors = ~is_object(counts, location.shape[1])
    while (wrong := _is_between(location) & distractors).any():
        location[wrong] = rng.uniform(0, _BETWEEN_WIDTH, size=(np.count_nonzero(wrong), 2))


def _range_of_objects(n_objects: NumberOfObjects, *, fewest: int) -> tuple[int, int]:
    lowest, highest = n_objects if isinstance(n_objects, tuple) else (n_objects, n_objects)
    lowest = at_least("n_objects", lowest, fewest)
    return lowest, at_least("the largest n_objects", highest, lowest)
