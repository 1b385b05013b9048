from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from checking.test_policies import PICKING
from mutations import damaged
from relforest.checking import check_policy, read_situations
from relforest.support.errors import InputError

GOOD = """
[[situation]]
name = "the thing on the left is worth it"
objects = [{id = "a", location = 0.8}, {id = "b", location = 0.2}, {id = "p"}]
actions = [["wait"], ["pick", "a"], ["pick", "b"]]
expect = {chosen = ["pick", "b"]}

[[situation]]
name = "nothing else is"
objects = [{location = 0.8}, {location = nan}]
actions = [["pick", 0], ["wait"]]
remaining = 3
[situation.expect]
better = ["wait"]
than = ["pick", 0]
"""


def write(folder: Path, text: str | bytes) -> Path:
    path = folder / "unit.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_situations_are_read_as_they_are_written(tmp_path: Path) -> None:
    first, second = read_situations(write(tmp_path, GOOD))

    assert (first.name, first.origin) == ("the thing on the left is worth it", str(tmp_path / "unit.toml"))
    assert first.fields == {"actions": [["wait"], ["pick", "a"], ["pick", "b"]]}
    assert second.expect == {"better": ["wait"], "than": ["pick", 0]}
    assert second.fields["remaining"] == 3
    assert [str(each) for each in check_policy(PICKING, (first, second))] == [
        f"ok      {first.name}",
        f"ok      {second.name}",
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must consist of tables [[situation]], at least one"),
        ("situation = []", "must consist of tables [[situation]], at least one"),
        ("situation = 3", "must consist of tables [[situation]], at least one"),
        (GOOD + "[world]\n", "must consist of tables [[situation]], at least one, and 'world' is not"),
        ("situation = [3]", "situation number 1 is 3: write a table [[situation]]"),
        ("[[situation]\n", "is not a TOML file: "),
        (b"\xff\xfe", "is not a TOML file: "),
        ("a = " + "[" * 100_000, "is nested too deeply"),
        ("[[situation]]\nobjects = []", "situation number 1 needs a name that says what must hold in words"),
        (GOOD.replace('"nothing else is"', '"\\u0007"'), "situation number 2 needs a name"),
        (GOOD.replace("nothing else is", "the thing on the left is worth it"), "two situations are named"),
        (GOOD.replace("objects", "things"), "situation 'the thing on the left is worth it' needs a list of "),
        (GOOD.replace("expect =", "wanted ="), "needs a table 'expect' of what must hold, got None"),
        (GOOD.replace('{chosen = ["pick", "b"]}', "{}"), "needs a table 'expect' of what must hold, got {}"),
    ],
)
def test_what_is_wrong_with_a_file_is_said(text: str | bytes, said: str, tmp_path: Path) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_situations(path)
    assert str(caught.value).startswith(str(path))
    assert said in str(caught.value)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml cannot be read: No such file"):
        read_situations(tmp_path / "none.toml")


def test_damaged_files_are_refused_or_work(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for _ in range(300):
        path = write(tmp_path, damaged(GOOD.encode(), rng))
        with suppress(InputError):
            check_policy(PICKING, read_situations(path))
