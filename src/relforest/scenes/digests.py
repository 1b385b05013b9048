"""Digests of columns, which reveal changes and damage to a file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import blake2b
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from relforest.scenes.arrow import ArrowArray, is_text, one_array

__all__ = ["column_digest", "document_digest"]


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
    else:
        digest.update(str(array.type).encode())
    return digest.hexdigest()


def document_digest(document: Mapping[str, Any]) -> str:
    """Return 16 hexadecimal digits that depend on a JSON document."""
    return blake2b(json.dumps(document, sort_keys=True).encode(), digest_size=8).hexdigest()
