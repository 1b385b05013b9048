"""Standard output and standard error of a command, on which writing never fails in the middle of the work.

A command that has learned for hours must still write its model when the reader of its output has gone. So the
first error of a stream is kept, what follows is dropped, and `app.main` reports the error at the end.
Characters that the encoding of a stream lacks are written as escape sequences.
"""

from __future__ import annotations

import errno
import io
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO, final


@final
class SafeStream(io.TextIOBase):
    """A text stream that writes to another one and keeps its first error.

    Parameters
    ----------
    stream : text stream or None
        The stream to write to; None is one that was closed when the process started.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.error: OSError | None = None

    @property
    def encoding(self) -> str:  # type: ignore[override] # an attribute in typeshed
        """The encoding of the other stream."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    def isatty(self) -> bool:
        """Return whether the other stream is a terminal."""
        return self._stream is not None and not self._stream.closed and self._stream.isatty()

    def fileno(self) -> int:
        """Return the descriptor of the other stream."""
        return super().fileno() if self._stream is None else self._stream.fileno()

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, text: str) -> int:
        """Write text, or drop it after an error."""
        if text:
            self._call("write", text.encode(self.encoding, "backslashreplace").decode(self.encoding))
        return len(text)

    def flush(self) -> None:
        """Flush the other stream."""
        if self._stream is not None:
            self._call("flush")

    def release(self) -> None:
        """Flush the other stream; after an error, close it, lest Python fail once more when it exits."""
        self.flush()
        if self.error is not None and self._stream is not None:
            with suppress(OSError):
                self._stream.close()

    def _call(self, method: str, *arguments: str) -> None:
        if self._stream is None or self._stream.closed:
            self.error = self.error or OSError(errno.EBADF, "it is closed")
        if self.error is None:
            try:
                getattr(self._stream, method)(*arguments)
            except OSError as error:
                self.error = error


def fill_closed_descriptors() -> None:
    """Open the null device in place of standard streams that are closed.

    Else the next file opened would take the place, and child processes would write their messages into it.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


@contextmanager
def short_warnings() -> Iterator[None]:
    """Show warnings as one line without a place in the source during the ``with`` block."""
    before = warnings.formatwarning
    warnings.formatwarning = lambda message, *_, **__: f"relforest: {message}\n"
    try:
        yield
    finally:
        warnings.formatwarning = before
