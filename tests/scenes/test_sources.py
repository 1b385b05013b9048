from __future__ import annotations

import bz2
import gzip
import io
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from relforest.scenes import read_table
from relforest.scenes.sources import name_of, read_bytes, read_text, unpacked
from relforest.support import files
from relforest.support.errors import InputError

TEXT = "s,é\n1,ü\n"


@pytest.mark.parametrize(
    ("encoding", "given"),
    [
        ("utf-8", None),
        ("utf-8-sig", None),
        ("utf-8-sig", "UTF8"),
        ("utf-16", None),
        ("utf-16-le", None),
        ("utf-16-be", None),
        ("utf-32", None),
        ("utf-16", "utf-16"),
        ("latin-1", "latin-1"),
        ("cp1252", "windows-1252"),
        ("cp437", "cp437"),
    ],
)
def test_text_of_any_encoding_is_read(encoding: str, given: str | None, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(TEXT.encode(encoding))

    assert read_text(path, given) == TEXT


@pytest.mark.parametrize(
    ("content", "encoding", "message"),
    [
        (
            TEXT.encode("latin-1"),
            None,
            r"t\.csv is not UTF-8 text \(byte 0xe9 in line 1\): pass its",
        ),
        (b"a\nb\n\xff", None, r"byte 0xff in line 3\): .* encoding='latin-1' \(--encoding latin-1\)"),
        (TEXT.encode(), "ascii", r"is not ASCII text \(byte 0xc3 in line 1\)"),
        (TEXT.encode("utf-16") + b"\x00", None, r"is not UTF-16-LE text"),
        (TEXT.encode(), "martian", "cannot be read with the encoding 'martian': name one such as utf-8"),
        (TEXT.encode(), "a\0b", "cannot be read with the encoding"),
        (TEXT.encode(), "hex", "cannot be read with the encoding 'hex'"),
        (TEXT.encode("utf-8-sig"), "latin-1", "is marked as UTF-8: leave out the encoding 'latin-1'"),
    ],
)
def test_text_in_another_encoding_is_refused(
    content: bytes, encoding: str | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(content)

    with pytest.raises(InputError, match=message):
        read_text(path, encoding)


@pytest.mark.parametrize(
    "packed",
    [
        gzip.compress(TEXT.encode()),
        bz2.compress(TEXT.encode()),
        pa.compress(TEXT.encode(), "zstd", asbytes=True),
    ],
    ids=["gzip", "bzip2", "zstd"],
)
def test_compressed_files_are_unpacked(packed: bytes, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(packed)
    assert read_text(path) == TEXT

    path.write_bytes(packed[:-8])
    with pytest.raises(InputError, match=r"t\.csv is damaged: it cannot be unpacked with"):
        read_bytes(path)


def test_what_is_compressed_is_unpacked_and_the_rest_left_alone() -> None:
    assert unpacked(gzip.compress(b"a,b") + gzip.compress(b",c") + bytes(3), "table") == b"a,b,c"
    assert unpacked(b"a,b", "table.gz") == b"a,b"
    assert unpacked(b"", "table") == b""


@pytest.mark.parametrize("damaged", [gzip.compress(b"a,b", mtime=0)[:-8] + bytes(8), b"\x1f\x8b"])
def test_damaged_compression_is_refused(damaged: bytes) -> None:
    with pytest.raises(InputError, match="table is damaged: it cannot be unpacked with gzip"):
        unpacked(damaged, "table")


def test_a_small_file_does_not_unpack_to_any_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.scenes.sources.MAX_INPUT_BYTES", 1000)
    path = tmp_path / "t.csv"
    path.write_bytes(bz2.compress(bytes(1001)))

    with pytest.raises(InputError, match="unpacks to more than the 1000 bytes allowed"):
        read_bytes(path)


@pytest.mark.parametrize("packed", [False, True])
def test_open_files_are_read(packed: bool) -> None:  # noqa: FBT001
    data = TEXT.encode()
    assert read_text(io.BytesIO(gzip.compress(data) if packed else data)) == TEXT
    assert read_text(io.StringIO(TEXT)) == TEXT


def test_open_files_are_named_in_messages(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(TEXT.encode("latin-1"))
    assert name_of(io.StringIO()) == "the open StringIO"
    with path.open("rb") as file, pytest.raises(InputError, match=r"t\.csv is not UTF-8 text"):
        read_text(file)
    with path.open(encoding="utf-8") as text, pytest.raises(InputError, match="is not utf-8 text: open"):
        read_text(text)
    with pytest.raises(InputError, match=r"t\.csv cannot be read: I/O operation on closed file"):
        read_text(text)


class Odd:
    def read(self) -> int:
        return 3


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("", "'' is not a path: give the name of a file"),
        ("a\0b.csv", r"'a\\x00b\.csv' is not a path"),
        ("https://example.org/t.csv", "is a web address: download the file and give its path"),
        (Path("https://example.org/t.csv"), "is a web address"),
        ("s3://bucket/t.parquet", "is a web address"),
        ("no/such/t.csv", r"file no/such/t\.csv does not exist: check the path"),
        ("x" * 5000 + ".csv", "cannot be read: File name too long; check the path"),
        (b"t.csv", "expected a path or an open file, got bytes"),
        (None, "expected a path or an open file, got NoneType"),
        (3, "expected a path or an open file, got int"),
        (Odd(), "the open Odd returns int instead of text or bytes"),
    ],
)
def test_other_sources_are_refused(source: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_bytes(source)
    with pytest.raises(InputError, match=message):
        read_table(source)


def test_half_a_character_is_refused() -> None:
    with pytest.raises(InputError, match=r"the open StringIO contains '\\ud800', which is not a character"):
        read_bytes(io.StringIO("\ud800"))


def test_a_folder_is_not_text(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder: give the name of a file"):
        read_bytes(tmp_path)


def test_plain_files_may_have_any_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.scenes.sources.MAX_INPUT_BYTES", 10)
    (tmp_path / "t.csv").write_bytes(bytes(100))

    assert len(read_bytes(tmp_path / "t.csv")) == 100
    assert files.MAX_INPUT_BYTES > 100
