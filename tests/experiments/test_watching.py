from __future__ import annotations

import threading

import pytest

from relforest.experiments.watching import watching


def test_what_is_watched_is_looked_at_meanwhile_and_once_more_at_the_end() -> None:
    looked = threading.Event()
    times: list[bool] = []

    def look() -> None:
        times.append(over)
        looked.set()

    over = False
    with watching(look):
        assert looked.wait(timeout=30)
        over = True

    assert times[0] is False
    assert times[-1] is True


def test_an_error_ends_the_watch() -> None:
    before = threading.active_count()
    with pytest.raises(ZeroDivisionError), watching(lambda: None):
        _ = 1 / 0

    assert threading.active_count() == before
