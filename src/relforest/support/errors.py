"""The exceptions that relforest raises on purpose; all of them are `RelforestError`."""

from __future__ import annotations


class RelforestError(Exception):
    """Base of every error that relforest raises deliberately."""


class InputError(RelforestError, ValueError):
    """Data or an option cannot be used; the message names it and the remedy."""


class ModelFormatError(RelforestError, ValueError):
    """A file or document is not a valid relforest model."""


class RunFolderError(RelforestError, RuntimeError):
    """A run folder is in use by another process, belongs to something else, or is damaged."""


class DataError(RelforestError, OSError):
    """The file of a published data set is missing, cannot be downloaded, or is the wrong file."""


class MissingDataError(DataError):
    """The file of a published data set was not found in any of the usual places."""
