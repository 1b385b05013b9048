from __future__ import annotations

import os
from pathlib import Path

import pytest

from relforest.cli.outputs import check_free
from relforest.support.errors import InputError


def test_new_files_and_folders_are_fine(tmp_path: Path) -> None:
    check_free(tmp_path / "new" / "deeper" / "tree.json", force=False)

    assert list(tmp_path.iterdir()) == []


def test_files_are_replaced_only_on_demand(tmp_path: Path) -> None:
    path = tmp_path / "tree.json"
    path.write_text("precious")

    with pytest.raises(InputError, match=r"tree\.json exists already: choose another name, or pass --force"):
        check_free(path, force=False)
    check_free(path, force=True)


def test_folders_are_no_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder: give the name of a file"):
        check_free(tmp_path, force=True)


def test_the_folder_must_allow_writing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is no folder that allows it"):
        check_free(tmp_path / "file" / "tree.json", force=False)

    # Root may write anywhere, so the question is answered for it.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(InputError, match="is no folder that allows it"):
        check_free(tmp_path / "tree.json", force=False)
