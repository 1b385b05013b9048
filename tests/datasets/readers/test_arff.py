from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from datasets.few_molecules import DATA, assert_few_molecules, assert_same_bags
from relforest.datasets import BagSet, read_arff
from relforest.support.errors import InputError
from strategies import BagSet as Drawn
from strategies import bag_sets

Write = Callable[[str], Path]
HEAD = """@relation r
@attribute id {a,b}
@attribute bag relational
@attribute f numeric
@attribute g {x,y,z}
@end bag
@attribute class {0,1}
@data
"""


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def file(content: str) -> Path:
        path = tmp_path / "bags.arff"
        path.write_bytes(content.encode())
        return path

    return file


def test_the_layout_of_weka_is_read() -> None:
    assert_few_molecules(read_arff(DATA / "few_molecules.arff"))


def test_nominal_attributes_become_one_component_per_value_in_order_of_declaration(write: Write) -> None:
    data = read_arff(write(HEAD + 'a,"1.5,z\\n2,x",1\nb,"-3,y",0\n'))
    # f, then whether g is x, y, z.
    assert [bag.tolist() for bag in data.bags] == [[[1.5, 0, 0, 1], [2, 1, 0, 0]], [[-3, 0, 1, 0]]]
    assert data.labels.tolist() == [True, False]


def test_everything_that_the_format_allows_is_understood(write: Write) -> None:
    data = read_arff(
        write(
            "% a comment\r\n"
            "  @RELATION 'two words'  % another\r\n\r\n"
            "@Attribute 'the name' string\r\n"
            '@ATTRIBUTE\t"a \\"bag\\"" Relational % { } in a comment\r\n'
            "    @attribute 'it''s' real\r\n".replace("''", "\\'")
            + "    @attribute (NI)odd INTEGER\r\n"
            "    @attribute shape { 'no, thing' , \"%\",plain } % values\r\n"
            "@end 'a \"bag\"'\r\n"
            "@attribute class {east,west}\r\n"
            "@DATA\r\n"
            "% between\r\n\r\n"
            "'first bag', '1, 2, \\'no, thing\\'\\n 3,4,\\\"%\\\" \\n', east % at the end\r\n"
            "second\t\"5,6,plain\"\t'west'\r\n"
        ),
        positive="east",
    )
    assert data.bag_ids.tolist() == ["first bag", "second"]
    assert data.labels.tolist() == [True, False]
    assert [bag.tolist() for bag in data.bags] == [[[1, 2, 1, 0, 0], [3, 4, 0, 1, 0]], [[5, 6, 0, 0, 1]]]


def test_labels_other_than_0_and_1_need_to_be_told_apart(write: Write) -> None:
    path = write(HEAD.replace("{0,1}", "{no,yes}") + 'a,"1,x",yes\nb,"1,x",no\n')
    assert read_arff(path, positive="no").labels.tolist() == [False, True]
    with pytest.raises(InputError, match="give positive='no' or positive='yes'"):
        read_arff(path)


@pytest.mark.parametrize("end", ["\\r\\n", "\\n", "\\r"])
def test_instances_may_end_as_lines_of_any_system_do(write: Write, end: str) -> None:
    data = read_arff(write(f'{HEAD}a,"1,x{end}2,y{end}",1\n'))
    assert data.bags[0].tolist() == [[1, 1, 0, 0], [2, 0, 1, 0]]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ('a,"1,x"', "line 9: 2 values instead of three: a name, a bag and a"),
        ('a,"1,x",1,1', "line 9: 4 values instead of three"),
        ('a,"1,x",2', "line 9: the label '2' is not declared: add it to the attribute 'class'"),
        ('a,"1,x",1\nc,"1,x",0', "line 10: the name 'c' is not declared: add it to the attribute 'id'"),
        (',"1,x",1', "line 9: the name of the bag is missing"),
        ("'',\"1,x\",1", "line 9: the name of the bag is missing"),
        ('a,"1,x",1\n\na,"1,x",1', "line 11: bag 'a' is already on line 9"),
        ('a,"1,w",1', "line 9: instance 1, attribute 'g': the value 'w' is not declared"),
        ('a,"1,x\\n1.2.3,x",1', "line 9: instance 2, attribute 'f': '1.2.3' is not a finite number"),
        ('a,"1,x\\n1",1', "line 9: instance 2 has 1 values, but 2 are declared"),
        ('a,"?,x",1', r"line 9: a value is missing \(\?\)"),
        ("a,?,1", r"line 9: a value is missing \(\?\)"),
        ('a,"",1', "line 9: the bag is empty"),
        ('{0 a, 1 "1,x", 2 1}', "line 9: sparse rows and weights"),
        ('a,"1,x",1,{5}', "line 9: sparse rows and weights"),
        ('a,"1,x",1 {5}', "line 9: sparse rows and weights"),
        ('a,"1,x,1', "line 9: a quote is not closed"),
        ("a,'1,x'y',1", 'line 9: a comma is missing before "y\',1"'),
        ('a b,"1,x",1', "line 9: a comma is missing before 'b,"),
        ("% nothing", "does not contain any bags after @data"),
    ],
)
def test_what_is_wrong_with_a_row_is_said(write: Write, row: str, message: str) -> None:
    path = write(HEAD + row + "\n")
    with pytest.raises(InputError, match=message) as error:
        read_arff(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("@end bag\n", "", "line 7: '@data' is not allowed here"),
        ("@end bag", "@fin bag", "line 6: '@fin' is not allowed here"),
        ("@attribute id {a,b}\n", "", r"line 7: .* declares 'bag' \(relational\), 'class' \(nominal\)"),
        ("f numeric", "f string", "line 8: attribute 'f' of the instances has type string"),
        ("f numeric", "f date yyyy", "line 8: attribute 'f' of the instances has type date"),
        ("f numeric", "f complex", "line 4: attribute 'f' has the type 'complex'"),
        ("f numeric", "f", "line 4: @attribute needs a name"),
        ("g {x,y,z}", "g {x,y,z", "line 5: the values of attribute 'g' must be enclosed in"),
        ("@attribute f numeric\n@attribute g {x,y,z}\n", "", "line 6: the relational attribute 'bag' lacks"),
        ("relational", "numeric", "line 6: '@end' is not allowed here"),
    ],
)
def test_what_is_wrong_with_the_head_is_said(write: Write, old: str, new: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_arff(write(HEAD.replace(old, new, 1) + 'a,"1,x",1\n'))


def test_a_file_that_ends_in_its_head_is_refused(write: Write) -> None:
    with pytest.raises(InputError, match="does not have an @data line: it is not an ARFF file, or trunc"):
        read_arff(write(HEAD.partition("@data")[0]))


def test_a_flat_table_is_refused_with_a_hint(write: Write) -> None:
    flat = "@relation r\n@attribute id {a}\n@attribute f numeric\n@attribute class {0,1}\n@data\na,1,1\n"
    with pytest.raises(InputError, match="Save a flat table as CSV and use read_csv"):
        read_arff(write(flat))


def quoted(text: str) -> str:
    """Quote as Weka does."""
    for character, escape in (("\\", "\\\\"), ("'", "\\'"), ('"', '\\"'), ("\n", "\\n"), ("\t", "\\t")):
        text = text.replace(character, escape)
    return f"'{text}'"


NAMES = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"), min_size=1, max_size=5)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(drawn=bag_sets(dim=2), data=st.data())
def test_what_is_written_is_read(write: Write, drawn: Drawn, data: st.DataObject) -> None:
    points, starts, labels = drawn
    names = data.draw(st.lists(NAMES, min_size=len(labels), max_size=len(labels), unique=True))
    shapes = data.draw(st.lists(NAMES, min_size=2, max_size=2, unique=True))
    expected = BagSet(np.split(points, starts[1:-1]), labels, np.array(names, dtype=object))
    head = (
        "@relation r\n@attribute id string\n@attribute bag relational\n@attribute f numeric\n"
        f"@attribute g numeric\n@attribute shape {{{','.join(map(quoted, shapes))}}}\n"
        "@end bag\n@attribute class {0,1}\n@data\n"
    )
    instances = [
        "\n".join(f"{f!r},{g!r},{quoted(shapes[1])}" for f, g in bag.tolist()) for bag in expected.bags
    ]
    rows = [
        f"{quoted(name)},{quoted(bag)},{int(label)}\n"
        for name, label, bag in zip(names, labels, instances, strict=True)
    ]
    wide = BagSet([np.insert(bag, [2, 2], [0, 1], axis=1) for bag in expected.bags], labels, expected.bag_ids)
    assert_same_bags(read_arff(write(head + "".join(rows))), wide)


VALID = HEAD + "a,\"1.5,z\\n2,x\",1\n'b',\"-3,'y'\",0\n"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_hostile_files_are_read_or_refused(write: Write, data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(VALID)))
    end = data.draw(st.integers(start, min(start + 8, len(VALID))))
    patch = data.draw(
        st.one_of(st.text(st.characters(codec="utf-8"), max_size=6), st.sampled_from("@{}%'\"\\,\n?\0"))
    )
    path = write(VALID[:start] + patch + VALID[end:])
    try:
        found = read_arff(path)
    except InputError as error:
        assert str(path) in str(error)  # noqa: PT017 - both outcomes are right
    else:
        assert all(np.isfinite(bag).all() for bag in found.bags)


def test_messages_say_what_they_mean(write: Write) -> None:
    with pytest.raises(InputError) as error:
        read_arff(write(HEAD.replace("f numeric", "f unknown")))
    assert str(error.value).endswith(
        "attribute 'f' has the type 'unknown': it must be numeric, string, relational or a list of values in "
        "braces, such as {a,b}"
    )


def test_other_encodings_and_open_files_are_read(tmp_path: Path) -> None:
    text = HEAD.replace("{a,b}", "{é}") + 'é,"1,x",1\n'
    (tmp_path / "bags.arff").write_bytes(text.encode("latin-1"))
    assert read_arff(tmp_path / "bags.arff", encoding="latin-1").bag_ids.tolist() == ["é"]
    with (tmp_path / "bags.arff").open("rb") as file:
        assert read_arff(file, encoding="latin-1").bag_ids.tolist() == ["é"]
    with pytest.raises(InputError, match=r"is not UTF-8 text \(byte 0xe9 in line 2\): pass its encoding"):
        read_arff(tmp_path / "bags.arff")
    with pytest.raises(InputError, match="is a folder"):
        read_arff(tmp_path)


def test_names_of_bags_are_read_as_they_are_written(write: Write) -> None:
    head = HEAD.replace("id {a,b}", "id numeric")
    assert read_arff(write(head + '01,"1,x",1\n1,"1,x",0\n1e0,"1,x",1\n')).bag_ids.tolist() == [
        "01",
        "1",
        "1e0",
    ]
