from __future__ import annotations

import io
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from relforest.cli.streams import SafeStream, short_warnings

VERSION = f"{sys.executable} -m relforest --version"
CLOSED = "relforest: cannot write to standard output: it is closed\n"


def shell(command: str) -> tuple[int, str, str]:
    """Run a command in a shell; return its exit code, what it wrote, and its errors."""
    done = subprocess.run(["/bin/bash", "-c", command], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_characters_that_the_encoding_lacks_are_escaped() -> None:
    below = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    stream = SafeStream(below)
    stream.write("é and \udce9")
    stream.flush()

    assert below.buffer.getvalue() == rb"\xe9 and \udce9"
    assert stream.error is None


def test_after_an_error_everything_is_dropped() -> None:
    below = io.StringIO()
    stream = SafeStream(below)
    assert stream.writable()
    stream.write("")
    below.close()
    stream.write("a")
    stream.write("b")
    stream.release()

    assert str(stream.error).endswith("it is closed")
    assert not stream.isatty()


def test_a_stream_that_is_missing_fails_only_when_it_is_written_to() -> None:
    stream = SafeStream(None)
    stream.flush()

    assert (stream.error, stream.encoding, stream.isatty()) == (None, "utf-8", False)
    with pytest.raises(io.UnsupportedOperation):
        stream.fileno()
    stream.write("text")
    stream.release()
    assert stream.error is not None


def test_a_stream_has_the_descriptor_of_the_one_below(tmp_path: Path) -> None:
    with (tmp_path / "file").open("w") as file:
        assert SafeStream(file).fileno() == file.fileno()


def test_warnings_are_one_line() -> None:
    before = warnings.formatwarning
    with short_warnings():
        text = warnings.formatwarning("take care", UserWarning, "file.py", 3)

    assert text == "relforest: take care\n"
    assert warnings.formatwarning is before


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (f"{VERSION} >&-", (1, "", CLOSED)),
        (f"{VERSION} >&- 2>&-", (1, "", "")),
        (f"{VERSION} >/dev/full", (1, "", CLOSED.replace("it is closed", "No space left on device"))),
        (f"{VERSION} | true; exit ${{PIPESTATUS[0]}}", (141, "", "")),
        (f"{VERSION} 2>&- | wc -l", (0, "1\n", "")),
        (f"{sys.executable} -m relforest fti 2>&-", (2, "", "")),
        (f"{sys.executable} -m relforest fti 2>/dev/full", (2, "", "")),
        (f"{sys.executable} -m relforest play --help | true; exit ${{PIPESTATUS[0]}}", (141, "", "")),
    ],
)
def test_closed_and_broken_streams_end_as_in_other_tools(
    command: str, expected: tuple[int, str, str]
) -> None:
    assert shell(command) == expected


def test_files_never_take_the_place_of_closed_streams() -> None:
    script = "import os; from relforest.cli.app import main; main(['fti']); os._exit(os.open('/dev/null', 0))"

    assert shell(f'{sys.executable} -c "{script}" <&- >&- 2>&-')[0] == 3
