from __future__ import annotations

import io
import json
import math
import os
import resource
import stat
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support import archives, files
from relforest.support.errors import InputError, ModelFormatError

HEAD = {"format": "relforest-tree", "version": 1}

scalars = st.none() | st.booleans() | st.integers(-(10**99), 10**99) | st.floats(-1e100, 1e100)
texts = st.text(st.characters(exclude_categories=["Cs", "Cc", "Cn"]), max_size=8)
documents = st.dictionaries(
    texts,
    st.recursive(
        scalars | texts, lambda inner: st.lists(inner) | st.dictionaries(texts, inner), max_leaves=8
    ),
)


def read(path: Path, **options: Any) -> dict[str, Any]:
    return files.read_json(path, format="relforest-tree", version=2, **options)


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_written_bytes_are_read_back_and_replace_what_was_there(tmp_path: Path) -> None:
    target = tmp_path / "a" / "b" / "model.bin"
    files.write_bytes(target, b"old, and longer")
    files.write_bytes(target, b"new")

    assert target.read_bytes() == b"new"
    assert names_in(target.parent) == ["model.bin"]


def test_a_file_written_in_pieces_appears_when_it_is_complete(tmp_path: Path) -> None:
    target = tmp_path / "a" / "table.bin"
    with files.replacing(target) as temporary:
        temporary.write_bytes(b"part")
        assert files.is_temporary(temporary)
        assert not target.exists()
    with suppress(KeyboardInterrupt), files.replacing(target) as temporary:
        temporary.write_bytes(b"other")
        raise KeyboardInterrupt

    assert target.read_bytes() == b"part"
    assert names_in(target.parent) == ["table.bin"]


@contextmanager
def at_most(size: int) -> Iterator[None]:
    """Let no file grow beyond a size, as on a disk that is almost full."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_is_reported_with_the_name_of_the_file(tmp_path: Path) -> None:
    target = tmp_path / "model.bin"
    files.write_bytes(target, b"old")

    with at_most(1000), pytest.raises(OSError, match="File too large") as caught:
        files.write_bytes(target, bytes(2000))

    assert caught.value.filename == str(target)
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["model.bin"]


def test_a_line_for_which_there_is_no_room_is_not_begun(tmp_path: Path) -> None:
    log = tmp_path / "timings.jsonl"
    files.append_line(log, "first")

    for size in (6, 10):
        with at_most(size), pytest.raises(OSError, match=r"No space|too large") as caught:
            files.append_line(log, "second and longer")
        assert caught.value.filename == str(log)
        assert log.read_text() == "first\n"


@pytest.mark.parametrize("write", [files.write_text, files.append_line])
def test_a_path_that_cannot_be_written_is_named(
    tmp_path: Path, write: Callable[[str | Path, str], None]
) -> None:
    (tmp_path / "file").write_text("here")
    long = "x" * 300

    with pytest.raises(NotADirectoryError) as through:
        write(tmp_path / "file" / "model.json", "text")
    with pytest.raises(OSError, match="too long") as too_long:
        write(tmp_path / long, "text")
    with pytest.raises(IsADirectoryError) as folder:
        write(tmp_path, "text")

    assert through.value.filename == str(tmp_path / "file")
    assert too_long.value.filename == str(tmp_path / long)
    assert folder.value.filename == str(tmp_path)
    for path, complaint in (("", "the output path is empty"), (tmp_path / "a\0b", "embedded null")):
        with pytest.raises(InputError, match=complaint):
            write(path, "text")
    assert names_in(tmp_path) == ["file"]


def test_a_pipe_is_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="pipe cannot be replaced: it is not a regular file"):
        files.write_text(tmp_path / "pipe", "text")

    assert (tmp_path / "pipe").is_fifo()
    assert names_in(tmp_path) == ["pipe"]


def test_the_longest_name_that_a_file_system_allows_can_be_written(tmp_path: Path) -> None:
    for name in ("x" * 255, "ü" * 127):
        files.write_text(tmp_path / name, "text")

    assert len(names_in(tmp_path)) == 2


def test_text_that_utf_8_cannot_express_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"note cannot be written as UTF-8: .* surrogates not allowed"):
        files.write_text(tmp_path / "note", "a\ud800")

    assert names_in(tmp_path) == []


@pytest.mark.parametrize("fault", ["os.fsync", "pathlib.Path.replace"])
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_before_the_rename_keeps_the_old_file_and_leaves_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str, error: BaseException
) -> None:
    target = tmp_path / "model.json"
    files.write_text(target, "old")

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(fault, fail)
    with pytest.raises(type(error)):
        files.write_text(target, "new")

    assert target.read_text() == "old"
    assert names_in(tmp_path) == ["model.json"]


def test_the_temporary_file_lies_beside_its_target(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    renamed = []
    rename = Path.replace

    def record(self: Path, target: Path) -> Path:
        renamed.append((self, self.read_bytes()))
        return rename(self, target)

    monkeypatch.setattr(Path, "replace", record)
    files.write_bytes(tmp_path / "model.bin", b"whole")

    ((temporary, content),) = renamed
    assert temporary.parent == tmp_path
    assert content == b"whole"


def test_a_folder_that_cannot_be_flushed_costs_only_durability(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flush = os.fsync

    def refuse_folders(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(22, "Invalid argument")
        flush(descriptor)

    monkeypatch.setattr("os.fsync", refuse_folders)
    files.write_text(tmp_path / "note", "kept")

    assert (tmp_path / "note").read_text() == "kept"


def test_writing_over_a_folder_fails_and_leaves_it(tmp_path: Path) -> None:
    (tmp_path / "model" / "inner").mkdir(parents=True)

    with pytest.raises(OSError, match="model"):
        files.write_text(tmp_path / "model", "text")

    assert names_in(tmp_path) == ["model"]


def test_a_link_keeps_pointing_to_the_file_it_named(tmp_path: Path) -> None:
    (tmp_path / "store").mkdir()
    link = tmp_path / "latest.json"
    link.symlink_to(tmp_path / "store" / "1.json")
    files.write_text(link, "content")

    assert link.is_symlink()
    assert (tmp_path / "store" / "1.json").read_text() == "content"


def test_json_is_indented_ordered_and_ends_its_last_line(tmp_path: Path) -> None:
    files.write_json(
        tmp_path / "model.json", {"version": 1, "format": "x", "name": "Zürich", "list": [1, 2.5]}
    )

    assert (tmp_path / "model.json").read_bytes().decode("utf-8") == (
        '{\n "version": 1,\n "format": "x",\n "name": "Zürich",\n "list": [\n  1,\n  2.5\n ]\n}\n'
    )


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_json_refuses_numbers_that_are_not_finite(tmp_path: Path, value: float) -> None:
    with pytest.raises(InputError, match=r"model\.json cannot be written as JSON: "):
        files.write_json(tmp_path / "model.json", {"radius": value})

    assert names_in(tmp_path) == []


@given(document=documents)
def test_json_written_is_json_read(
    tmp_path_factory: pytest.TempPathFactory, document: dict[str, Any]
) -> None:
    path = tmp_path_factory.mktemp("json") / "model.json"
    whole = {**document, **HEAD}
    files.write_json(path, whole)

    assert read(path) == whole
    assert list(read(path)) == list(whole)


def nested(depth: int) -> str:
    return '{"format": "relforest-tree", "version": 1, "x": ' + "[" * (depth - 1) + "]" * (depth - 1) + "}"


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "it is not valid JSON"),
        (b'{"format": "relforest-tree", "vers', "it is not valid JSON"),
        (b'{"format": "relforest-tree", "version": 1} {}', "it is not valid JSON"),
        (b'{"format": "relforest-tree", "version": 1, "version": 2}', "the key 'version' appears twice"),
        (b'{"format": "relforest-tree", "version": 1, "x": ' + b"9" * 5000 + b"}", "it is not valid JSON"),
        (bytes(range(256)), "it is not UTF-8 text"),
        (b"\x89PNG\r\n\x1a\n", "it is not UTF-8 text"),
        (b"[" * 200_000, "nested more than 64 levels deep"),
        (nested(100_000).encode(), "nested more than 64 levels deep"),
        (nested(65).encode(), "nested more than 64 levels deep"),
        (b"[1, 2]", "expected an object, got list"),
        (b"null", "expected an object, got NoneType"),
        (b"{}", "the key 'format' is missing"),
        (b'{"format": "relforest-policy", "version": 1}', "its format is 'relforest-policy'"),
        (b'{"format": ["relforest-tree"], "version": 1}', "its format is \\['relforest-tree'\\]"),
        (b'{"format": "relforest-tree"}', "an invalid version: expected an integer from 1 to 2, got None"),
        (b'{"format": "relforest-tree", "version": "1"}', "an invalid version: .*, got '1'"),
        (b'{"format": "relforest-tree", "version": true}', "an invalid version: .*, got True"),
        (b'{"format": "relforest-tree", "version": 0}', "an invalid version: .*, got 0"),
        (b'{"format": "relforest-tree", "version": 3}', "written by a newer relforest: .* upgrade relforest"),
        (b'{"format": "relforest-tree", "version": 1, "x": NaN}', "a number that is not finite"),
        (b'{"format": "relforest-tree", "version": 1, "x": [-Infinity]}', "a number that is not finite"),
        (b'{"format": "relforest-tree", "version": 1, "x": {"y": 1e999}}', "a number that is not finite"),
    ],
    ids=lambda value: value[:40].decode("latin-1") if isinstance(value, bytes) else None,
)
def test_hostile_json_is_refused_with_its_path(tmp_path: Path, content: bytes, complaint: str) -> None:
    path = tmp_path / "hostile.json"
    path.write_bytes(content)

    with pytest.raises(ModelFormatError, match=rf"hostile\.json .*{complaint}"):
        read(path)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            "[" + "0," * 2_000_000 + "0]",
            "is too large: at most 2000000 values",
        ),
        ("[" + "{}," * 250_000 + "0]", "is too large"),
        ("{" + '"a":1,' * 1_000_000 + '"b":1}', "is too large"),
        ("1" + "0" * 400, r"contains 10+\.\.\.0+, which exceeds 1e\+100"),
        ("-1e101", "contains -1e\\+101, which exceeds 1e\\+100"),
        ('"' + "x" * 10_001 + '"', "contains text of 10001 characters: at most 10000 are allowed"),
        ('"a\\u0000b"', r"contains the character U\+0000 in 'a\\x00b'"),
        ('["\\u001b[31m"]', r"contains the character U\+001B"),
        ('"\\ud800"', r"contains the character U\+D800"),
        ('{"\\u0007": 1}', r"contains the character U\+0007"),
    ],
    ids=range(10),
)
def test_values_that_could_do_harm_later_are_refused(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "hostile.json"
    path.write_text('{"format": "relforest-tree", "version": 1, "x": ' + text + "}")

    with pytest.raises(ModelFormatError, match=rf"hostile\.json {complaint}"):
        read(path)


@pytest.mark.parametrize("value", ["a\0b", "\ud800", 1e101, 10**101, {1: 2}, object(), "x" * 10_001])
def test_what_could_not_be_read_is_not_written(tmp_path: Path, value: object) -> None:
    with pytest.raises(
        InputError, match=r"model\.json cannot be written as JSON: the document (contains|has) "
    ):
        files.write_json(tmp_path / "model.json", {"x": value})

    assert names_in(tmp_path) == []


def test_json_nested_as_deep_as_allowed_is_read(tmp_path: Path) -> None:
    path = tmp_path / "deep.json"
    path.write_text(nested(64))

    assert read(path)["version"] == 1


def test_an_older_version_is_left_to_the_caller(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    files.write_json(path, HEAD)

    assert read(path) == HEAD


def test_a_missing_file_and_a_folder_are_no_models(tmp_path: Path) -> None:
    with pytest.raises(ModelFormatError, match=r"absent\.json cannot be read: No such file or directory"):
        read(tmp_path / "absent.json")
    with pytest.raises(ModelFormatError, match="cannot be read: it is not a regular file"):
        read(tmp_path)
    with pytest.raises(ModelFormatError, match=r"cannot be read: .*embedded null"):
        read(tmp_path / "a\0b")


def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")

    with pytest.raises(ModelFormatError, match="pipe cannot be read: it is not a regular file"):
        read(tmp_path / "pipe")


def test_a_file_over_the_limit_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "model.json"
    files.write_json(path, HEAD)
    size = path.stat().st_size

    monkeypatch.setattr(files, "MAX_DOCUMENT_BYTES", size)
    assert read(path) == HEAD
    monkeypatch.setattr(files, "MAX_DOCUMENT_BYTES", size - 1)
    with pytest.raises(ModelFormatError, match=rf"is larger than the {size - 1} bytes allowed"):
        read(path)


@pytest.mark.parametrize(
    ("value", "complaint"),
    [
        (np.int64(3), "here contains a int64, which is not JSON"),
        ({3: "x"}, "here has the key 3, which is not a string"),
        ([math.nan], r"here contains a number that is not finite \(nan\)"),
    ],
)
def test_a_parsed_document_is_held_to_the_same_rules(value: object, complaint: str) -> None:
    with pytest.raises(ModelFormatError, match=complaint):
        files.check_document({**HEAD, "x": value}, format="relforest-tree", version=1, origin="here")


def test_a_document_that_contains_itself_is_too_deep() -> None:
    document: dict[str, Any] = dict(HEAD)
    document["self"] = [document, document]

    with pytest.raises(ModelFormatError, match="here is nested more than 64 levels deep"):
        files.check_document(document, format="relforest-tree", version=1, origin="here")


def arrays() -> dict[str, np.ndarray[Any, Any]]:
    return {
        "weights": np.array([[1.5, np.nan], [-np.inf, 0.0]]),
        "counts": np.arange(3, dtype=np.int64),
        "none": np.empty((0, 4)),
        "across": np.arange(6.0, dtype=np.float32).reshape(2, 3).T,
        "alone": np.array(7),
    }


def test_arrays_written_are_arrays_read_in_the_order_asked(tmp_path: Path) -> None:
    files.write_npz(tmp_path / "weights.npz", arrays())
    read_back = files.read_npz(tmp_path / "weights.npz", ["alone", "across", "none", "counts", "weights"])

    assert list(read_back) == ["alone", "across", "none", "counts", "weights"]
    for name, array in arrays().items():
        np.testing.assert_array_equal(read_back[name], array, strict=True)


def test_equal_arrays_give_equal_bytes_that_numpy_reads(tmp_path: Path) -> None:
    for name in ("one.npz", "two.npz"):
        files.write_npz(tmp_path / name, arrays())

    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "one.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    with np.load(tmp_path / "one.npz", allow_pickle=False) as loaded:
        np.testing.assert_array_equal(loaded["counts"], [0, 1, 2])


def test_only_arrays_of_numbers_and_booleans_are_written(tmp_path: Path) -> None:
    for values, held in (
        (np.array([None], dtype=object), "Python objects"),
        (np.array(["a"]), "values of type <U1"),
        (np.array(["2000-01-01"], dtype="M8[D]"), r"values of type datetime64\[D\]"),
    ):
        with pytest.raises(InputError, match=f"array 'ids' cannot be written to .*: it contains {held}"):
            files.write_npz(tmp_path / "weights.npz", {"ids": values})

    assert names_in(tmp_path) == []


def test_a_missing_array_is_named(tmp_path: Path) -> None:
    files.write_npz(tmp_path / "weights.npz", arrays())

    with pytest.raises(ModelFormatError, match=r"array 'bias' is missing from .*weights\.npz"):
        files.read_npz(tmp_path / "weights.npz", ["counts", "bias"])


def test_optional_arrays_may_be_missing(tmp_path: Path) -> None:
    files.write_npz(tmp_path / "weights.npz", arrays())

    read_back = files.read_npz(tmp_path / "weights.npz", ["counts", "bias"], optional=("counts", "bias"))

    assert list(read_back) == ["counts"]


def archive_of(member: bytes, method: int = zipfile.ZIP_DEFLATED, *, copies: int = 1) -> bytes:
    buffer = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(buffer, "w", method) as archive:
        warnings.simplefilter("ignore")
        for _ in range(copies):
            archive.writestr("counts.npy", member)
    return buffer.getvalue()


def npy(array: np.ndarray[Any, Any], *, allow_pickle: bool = False) -> bytes:
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, array, allow_pickle=allow_pickle)
    return buffer.getvalue()


COUNTS = npy(np.arange(3))
DAMAGED = "array 'counts' of .* is damaged, or not of numbers and booleans: "


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "is not a readable archive of arrays"),
        (b"not an archive", "is not a readable archive of arrays"),
        (COUNTS, "is not a readable archive of arrays"),
        (archive_of(COUNTS)[:-30], "is not a readable archive of arrays"),
        (archive_of(COUNTS.replace(b"NUMPY", b"NUMPi")), DAMAGED),
        (archive_of(COUNTS.replace(b"\x01\x00", b"\x07\x00", 1)), DAMAGED),
        (archive_of(b""), DAMAGED),
        (archive_of(COUNTS[:60]), DAMAGED),
        (archive_of(COUNTS.replace(b"(3,)", b"(3,")), DAMAGED),
        (archive_of(COUNTS.replace(b"(3,)", b"(x,)")), DAMAGED),
        (archive_of(COUNTS.replace(b"(3,), }" + b" " * 40, b"(" + b"1" * 46)), DAMAGED),
        (archive_of(COUNTS.replace(b"'<i8'", b"print")), DAMAGED),
        (archive_of(COUNTS[:-1]), DAMAGED),
        (archive_of(COUNTS + b"x"), r"it has more bytes than fill the shape \(3,\)"),
        (archive_of(COUNTS.replace(b"(3,)", b"(9,)")), DAMAGED),
        (archive_of(COUNTS.replace(b"(3,), }         ", b"(3000000000,), }")), DAMAGED),
        (
            archive_of(npy(np.empty((0, 1, 1))).replace(b"(0, 1, 1)", b"(0, 9876543210, 9876543210)")),
            DAMAGED,
        ),
        (archive_of(npy(np.array([True, False]))[:-1] + b"\x02"), "it contains booleans other than 0 and 1"),
        (archive_of(npy(np.array([print], dtype=object), allow_pickle=True)), DAMAGED),
        (archive_of(npy(np.array(["text"]))), "only numbers and booleans"),
        (archive_of(npy(np.zeros(2, dtype="i4,f8"))), "only numbers and booleans"),
        (archive_of(COUNTS, zipfile.ZIP_LZMA), "uses a compression method that NumPy does not use"),
        (archive_of(COUNTS, zipfile.ZIP_BZIP2), "uses a compression method that NumPy does not use"),
        (archive_of(COUNTS, copies=2), "two of its arrays have the same name"),
        (b"PK\x01\x02" * 10_001, "contains more than 10000 arrays"),
    ],
)
def test_hostile_archives_are_refused_with_their_path(tmp_path: Path, content: bytes, complaint: str) -> None:
    path = tmp_path / "hostile.npz"
    path.write_bytes(content)

    with pytest.raises(ModelFormatError, match=complaint) as caught:
        files.read_npz(path, ["counts"])

    assert "hostile.npz" in str(caught.value)


@pytest.mark.parametrize("position", range(0, len(archive_of(COUNTS)), 7))
def test_an_archive_with_one_damaged_byte_is_refused_or_intact(tmp_path: Path, position: int) -> None:
    content = bytearray(archive_of(COUNTS))
    content[position] ^= 0xFF
    path = tmp_path / "damaged.npz"
    path.write_bytes(content)

    try:
        read_back = files.read_npz(path, ["counts"])["counts"].tolist()
    except ModelFormatError:
        read_back = [0, 1, 2]

    assert read_back == [0, 1, 2]


def test_an_archive_that_unpacks_to_too_much_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "MAX_BYTES", 10_000)
    path = tmp_path / "bomb.npz"
    path.write_bytes(archive_of(npy(np.zeros(100_000))))

    assert path.stat().st_size < 10_000
    with pytest.raises(
        ModelFormatError, match=r"bomb\.npz unpacks to 800128 bytes, more than the 10000 allowed"
    ):
        files.read_npz(path, ["counts"])


def test_lines_are_appended_and_a_torn_one_is_ended_first(tmp_path: Path) -> None:
    log = tmp_path / "logs" / "timings.jsonl"
    files.append_line(log, '{"iteration": 0}')
    files.append_line(log, '{"iteration": 1}')
    with log.open("ab") as file:
        file.write(b'{"itera')
    files.append_line(log, '{"iteration": 2}')

    assert log.read_text() == '{"iteration": 0}\n{"iteration": 1}\n{"itera\n{"iteration": 2}\n'


@pytest.mark.parametrize("text", ["a\nb", "a\r", "\n", "a\0b", "\ud800"])
def test_only_single_lines_are_appended(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match="only single lines of text can be appended to"):
        files.append_line(tmp_path / "log", text)

    assert names_in(tmp_path) == []


def test_a_json_document_is_plain_json_to_others(tmp_path: Path) -> None:
    files.write_json(tmp_path / "model.json", {**HEAD, "leaves": [0.25, 0.75]})

    assert json.loads((tmp_path / "model.json").read_text()) == {**HEAD, "leaves": [0.25, 0.75]}


def test_inputs_are_read_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "table").write_bytes(b"\x00a,b")
    assert files.read_input(tmp_path / "table") == b"\x00a,b"


def test_inputs_that_cannot_be_read_are_refused(tmp_path: Path) -> None:
    (tmp_path / "large").write_bytes(bytes(11))
    with pytest.raises(InputError, match="large is larger than the 10 bytes allowed; check the path"):
        files.read_input(tmp_path / "large", max_bytes=10)
    with pytest.raises(InputError, match="none cannot be read: No such file or directory; check the path"):
        files.read_input(tmp_path / "none")
    with pytest.raises(InputError, match="it is not a regular file; check the path"):
        files.read_input(tmp_path)
