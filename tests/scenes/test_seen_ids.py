from __future__ import annotations

import pyarrow as pa
from hypothesis import given
from hypothesis import strategies as st

from relforest.scenes.seen_ids import SeenIds


@given(
    parts=st.lists(st.lists(st.integers(-6, 30), max_size=5), max_size=9),
    as_text=st.booleans(),
)
def test_only_ids_that_were_added_before_are_found(parts: list[list[int]], as_text: bool) -> None:  # noqa: FBT001
    seen, known = SeenIds(), set[int]()
    for part in parts:
        again = [i for i, number in enumerate(part) if number in known or number in part[:i]]
        ids = pa.array([str(number) for number in part] if as_text else part)
        ids = ids.cast(pa.large_string() if as_text else pa.int64())

        assert seen.add(ids) == (again[0] if again else None)
        if again:
            return
        known |= set(part)
