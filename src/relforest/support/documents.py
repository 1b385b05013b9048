"""What relforest's JSON documents may contain: a limited number of plain values, finite numbers, clean text.

Every document is checked here when it is written and when it is read, so that the rest of the code need not
handle numbers that overflow or text that cannot be displayed.
"""

from __future__ import annotations

import re
import reprlib
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

from relforest.support.errors import ModelFormatError

MAX_DEPTH: Final = 64
MAX_VALUES: Final = 2_000_000
"""A tree of 1000 questions in 3 dimensions, with its sample of points, has about 1 million values."""
MAX_KEYS: Final = 1_000_000
MAX_OBJECTS: Final = 250_000
LARGEST_NUMBER: Final = 1e100
"""Squares of such numbers, and sums of many squares, do not overflow."""
LONGEST_TEXT: Final = 10_000

# Control characters except tab and line feed, lone surrogates, and code points that are not characters.
_UNCLEAN: Final = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def check_extent(data: bytes, origin: str) -> None:
    """Check that JSON text is not too large, before parsing it.

    Raises
    ------
    ModelFormatError
        If it may contain more than `MAX_VALUES` values, `MAX_KEYS` keys or `MAX_OBJECTS` objects.
    """
    objects = data.count(b"{")
    values = data.count(b",") + data.count(b"[") + objects
    if values > MAX_VALUES or data.count(b":") > MAX_KEYS or objects > MAX_OBJECTS:
        raise ModelFormatError(
            f"{origin} is too large: at most {MAX_VALUES} values, {MAX_KEYS} keys and "
            f"{MAX_OBJECTS} objects are allowed"
        )


def check_values(document: object, origin: str) -> None:
    """Check every value of a document made of dict, list, tuple, str, int, float, bool and None.

    Raises
    ------
    ModelFormatError
        If it is nested more than `MAX_DEPTH` levels deep, or contains anything that is not JSON, a number
        that is not finite or exceeds `LARGEST_NUMBER`, or text that is longer than `LONGEST_TEXT` or contains
        lone surrogates or control characters other than tab and line feed.
    """
    pending: list[tuple[Any, int]] = [((document,), 0)]
    while pending:
        members, depth = pending.pop()
        if depth > MAX_DEPTH:
            raise ModelFormatError(f"{origin} is nested more than {MAX_DEPTH} levels deep")
        if isinstance(members, dict):
            _check_keys(members, origin)
            members = members.values()
        for value in members:
            if isinstance(value, (float, int)):
                # The negated test also catches NaN.
                if not -LARGEST_NUMBER <= value <= LARGEST_NUMBER:
                    _refuse_number(value, origin)
            elif isinstance(value, str):
                _check_text(value, origin)
            elif isinstance(value, (dict, list, tuple)):
                pending.append((value, depth + 1))
            elif value is not None:
                raise ModelFormatError(f"{origin} contains a {type(value).__name__}, which is not JSON")


def is_clean(text: str) -> bool:
    """Return whether text can be stored and displayed; see `check_values`."""
    return len(text) <= LONGEST_TEXT and not _UNCLEAN.search(text)


@contextmanager
def well_formed(complaint: str, remedy: str = "") -> Iterator[None]:
    """Turn the errors that a ``with`` block raises on a malformed document into `ModelFormatError`.

    Its message begins with the complaint, such as ``"model.json is damaged"``, and ends with the remedy.
    """
    end = f"; {remedy}" if remedy else ""
    try:
        yield
    except KeyError as error:
        raise ModelFormatError(
            f"{complaint}: the key {reprlib.repr(error.args[0])} is missing{end}"
        ) from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise ModelFormatError(f"{complaint}: {str(error) or type(error).__name__:.500}{end}") from error


def without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Build a dictionary for ``json.loads``, raising `ValueError` if a key is repeated."""
    result = dict(pairs)
    if len(result) < len(pairs):
        (repeated, _), *_ = Counter(key for key, _ in pairs).most_common(1)
        raise ValueError(f"the key {reprlib.repr(repeated)} appears twice in one object")
    return result


def _check_keys(members: Mapping[Any, object], origin: str) -> None:
    for key in members:
        if not isinstance(key, str):
            raise ModelFormatError(f"{origin} has the key {reprlib.repr(key)}, which is not a string")
        _check_text(key, origin)


def _check_text(text: str, origin: str) -> None:
    if len(text) > LONGEST_TEXT:
        raise ModelFormatError(
            f"{origin} contains text of {len(text)} characters: at most {LONGEST_TEXT} are allowed"
        )
    found = _UNCLEAN.search(text)
    if found:
        raise ModelFormatError(
            f"{origin} contains the character U+{ord(found[0]):04X} in {reprlib.repr(text)}: control "
            "characters and lone surrogates are not allowed"
        )


def _refuse_number(number: float, origin: str) -> None:
    if isinstance(number, float) and (number != number or number in {float("inf"), float("-inf")}):  # noqa: PLR0124
        raise ModelFormatError(f"{origin} contains a number that is not finite ({number})")
    raise ModelFormatError(f"{origin} contains {reprlib.repr(number)}, which exceeds {LARGEST_NUMBER:g}")
