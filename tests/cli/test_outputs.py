from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from relforest.cli.outputs import check_free, print_data
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


def test_folders_and_devices_are_not_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder: give the name of a file"):
        check_free(tmp_path, force=True)
    with pytest.raises(InputError, match="/dev/null is not a regular file: give another name"):
        check_free(Path("/dev/null"), force=True)


def test_impossible_paths_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"cannot write .*file/tree\.json: Not a directory"):
        check_free(tmp_path / "file" / "tree.json", force=False)
    with pytest.raises(InputError, match=r"cannot write .*xxx: File name too long"):
        check_free(tmp_path / ("x" * 300), force=False)


def test_the_folder_must_be_writable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "tree.json").write_text("")

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    # Root may write anywhere, so the question is answered for it.
    monkeypatch.setattr(Path, "mkdir", refuse)
    for name in ("tree.json", "new.json", "folder/new.json"):
        with pytest.raises(InputError, match=f"cannot write to folder {tmp_path}: Permission denied"):
            check_free(tmp_path / name, force=True)


def test_data_are_printed_as_they_are_or_not_at_all(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    print_data("é,1\n")
    assert capsys.readouterr().out == "é,1\n"

    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    with pytest.raises(
        InputError, match=r"cannot express '\\xe9' in its encoding ascii: write to a file with"
    ):
        print_data("1,é\n")
