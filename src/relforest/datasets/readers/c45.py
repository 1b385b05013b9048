"""The C4.5 ``.data`` files of the UCI repository, such as Musk: one line per instance."""

from __future__ import annotations

from collections.abc import Iterator

from relforest.datasets.bag_set import BagSet
from relforest.datasets.readers.fields import FieldError, at_line, number, split_lines
from relforest.datasets.readers.flat_rows import Row, gather
from relforest.scenes.sources import Source, name_of, read_text


def read_c45(
    path: Source,
    *,
    instance_ids: bool | None = None,
    positive: str | None = None,
    encoding: str | None = None,
) -> BagSet:
    """Read bags from a C4.5 ``.data`` file such as ``clean1.data`` of Musk.

    Parameters
    ----------
    path : path or open file
        The ``.data`` file; a ``.names`` file beside it is not needed. It may be compressed with gzip.
    instance_ids : bool, optional
        Whether the second field is the name of the instance (Musk: of the conformation), which is dropped, or
        the first feature; required if it is a number, otherwise a name by default.
    positive : str, optional
        The label of positive bags; needed if labels are other than 0 and 1, -1 and 1, false and true, of
        which the second is positive.
    encoding : str, optional
        Default: UTF-8, or UTF-16 where the first bytes show it.

    Returns
    -------
    BagSet
        Bags in the order of their first instance; the rows of a bag may be anywhere.

    Raises
    ------
    InputError
        If the file cannot be read, the number of fields varies, a feature is missing or not a finite number,
        ``instance_ids`` is needed and not given, or labels are unclear; the message names the line.

    Notes
    -----
    A line holds, separated by commas: the bag's name, the instance's name (see ``instance_ids``), the
    features, all of them numbers, and the label, with or without a dot at its end. From ``|`` on
    a line is a comment.
    """
    origin = name_of(path)
    return gather(_rows(read_text(path, encoding), origin, instance_ids=instance_ids), positive, origin)


def _rows(text: str, origin: str, *, instance_ids: bool | None) -> Iterator[Row]:
    n_names = 1 if instance_ids is False else 2
    expected: int | None = None
    for line_number, line in enumerate(split_lines(text), start=1):
        fields = [field.strip() for field in line.partition("|")[0].split(",")]
        if fields == [""]:
            continue
        features = fields[n_names:-1]
        with at_line(origin, line_number):
            _check_length(features, expected, n_names)
            _check_second(fields[1], instance_ids=instance_ids)
            point = [number(feature) for feature in features]
        expected = len(features)
        yield Row(line_number, fields[0], fields[-1].removesuffix("."), point)


def _check_length(features: list[str], expected: int | None, n_names: int) -> None:
    if not features:
        names = "a bag, an instance" if n_names == 2 else "a bag"
        raise FieldError(
            f"a line needs {names}, features and a label, separated by commas (see instance_ids)"
        )
    if expected not in {None, len(features)}:
        raise FieldError(f"the line has {len(features)} of {expected} features: complete it")


def _check_second(field: str, *, instance_ids: bool | None) -> None:
    """Refuse a second field that contradicts ``instance_ids`` or is ambiguous without it."""
    try:
        number(field)
    except FieldError as error:
        if instance_ids is False:
            raise FieldError(f"{error}; if it is the name of the instance, give instance_ids=True") from error
    else:
        if instance_ids is None:
            raise FieldError(
                f"the second field, {field!r}, may be the name of the instance or its first feature: give "
                "instance_ids=True or instance_ids=False"
            )
