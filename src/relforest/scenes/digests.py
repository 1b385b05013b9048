"""Digests of columns, which reveal changes and damage to a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import blake2b
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrow import ArrowArray, is_text, one_array

BLOCK_ROWS: Final = 2**16
"""Rows that have a digest of their own, so that a file can be checked while it is read in pieces."""


def column_digest(column: ArrowArray) -> str:
    """Return 16 hexadecimal digits that depend on type, nulls and values, but not on storage."""
    array = one_array(column)
    valid = pc.is_valid(array).to_numpy(zero_copy_only=False)
    digest = blake2b(np.packbits(valid).tobytes(), digest_size=8)
    if is_text(array.type):
        text = pc.fill_null(pc.cast(array, pa.large_string()), "")
        lengths = pc.binary_length(text).to_numpy(zero_copy_only=False)
        digest.update(b"text" + lengths.tobytes())
        _, offsets, letters = text.buffers()
        if letters is not None:
            first, last = np.frombuffer(offsets, dtype=np.int64)[[text.offset, text.offset + len(text)]]
            digest.update(letters[first:last])
    elif pa.types.is_integer(array.type) or pa.types.is_floating(array.type):
        values = pc.fill_null(array, 0).to_numpy(zero_copy_only=False)
        wide = values.astype(np.float64 if values.dtype.kind == "f" else np.int64)
        digest.update(wide.dtype.str.encode() + wide.tobytes())
    elif pa.types.is_list(array.type) or pa.types.is_large_list(array.type):
        lengths = pc.fill_null(pc.cast(pc.list_value_length(array), pa.int64()), 0)
        digest.update(b"list" + lengths.to_numpy(zero_copy_only=False).tobytes())
        digest.update(column_digest(pc.list_flatten(array)).encode())
    else:
        digest.update(str(array.type).encode())
    return digest.hexdigest()


def block_digests(column: ArrowArray) -> list[str]:
    """Return the digest of every `BLOCK_ROWS` rows of a column."""
    return [column_digest(column.slice(row, BLOCK_ROWS)) for row in range(0, len(column), BLOCK_ROWS)]


def is_unchanged(column: ArrowArray, digests: object, block: int | None = None) -> bool:
    """Compare a column, or one block of it, with the digests of the column that a file contains.

    An empty column at the number of blocks there should be shows that none is missing.
    """
    if block is not None and isinstance(digests, list):
        digests = digests[block : block + 1]
    return digests == block_digests(column)


def document_digest(document: Mapping[str, Any]) -> str:
    """Return 16 hexadecimal digits that depend on a JSON document."""
    return blake2b(json.dumps(document, sort_keys=True).encode(), digest_size=8).hexdigest()
