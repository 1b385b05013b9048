from __future__ import annotations

import pytest

from relforest.support.errors import DataError, InputError, ModelFormatError, RelforestError, RunFolderError


@pytest.mark.parametrize(
    ("error", "builtin"),
    [
        (DataError, OSError),
        (InputError, ValueError),
        (ModelFormatError, ValueError),
        (RunFolderError, RuntimeError),
    ],
)
def test_every_error_can_be_caught_as_ours_or_as_the_builtin(
    error: type[RelforestError], builtin: type[Exception]
) -> None:
    for error_type in (RelforestError, builtin):
        with pytest.raises(error_type, match="the reason"):
            raise error("the reason")
