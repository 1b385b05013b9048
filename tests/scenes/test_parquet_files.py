from __future__ import annotations

import gzip
import io
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from pyarrow import parquet

from relforest.scenes import Scenes, parquet_files, read_table
from relforest.scenes.parquet_files import parquet_from_bytes
from relforest.scenes.parquet_source import open_parquet
from relforest.support.errors import InputError


def write(path: Path, **options: Any) -> Path:
    """Write columns s and x, and others that are not used."""
    columns = {"s": ["a", "b"], "x": [0.5, 1.5], "nested": [{"x": 1}, None], "lists": [[1], []]}
    parquet.write_table(pa.table(columns | options), path)
    return path


def scenes_of(path: Path) -> Scenes:
    return Scenes.from_parquet(path, scene="s", attributes={"x": "x"})


def test_only_columns_that_are_named_are_read(tmp_path: Path) -> None:
    file = open_parquet(write(tmp_path / "t.parquet"))

    assert file.names == ("s", "x", "nested", "lists")
    assert file.read(["x", "s"]).to_pydict() == {"x": [0.5, 1.5], "s": ["a", "b"]}
    with pytest.raises(
        InputError, match=r"'y' is missing from .*t\.parquet, which has 's', 'x', 'nested', 'lists'"
    ):
        file.read(["y"])


def test_a_column_is_not_mistaken_for_a_part_of_another(tmp_path: Path) -> None:
    path = write(tmp_path / "t.parquet", **{"nested.x": [3.0, 4.0]})

    assert read_table(path, columns=["nested.x"]).to_pydict() == {"nested.x": [3.0, 4.0]}


def test_the_content_may_be_an_open_file_or_compressed(tmp_path: Path) -> None:
    path = write(tmp_path / "t.parquet")
    data = path.read_bytes()
    (tmp_path / "t.parquet.gz").write_bytes(gzip.compress(data))

    assert read_table(io.BytesIO(data), columns=["x"]).column("x").to_pylist() == [0.5, 1.5]
    assert read_table(tmp_path / "t.parquet.gz", columns=["x"]).column("x").to_pylist() == [0.5, 1.5]


def test_categories_are_read_as_their_values(tmp_path: Path) -> None:
    frame = pd.DataFrame({"s": pd.Categorical(["v", "u", "v"]), "x": pd.Categorical([1.5, 2.5, 1.5])})
    frame.to_parquet(tmp_path / "t.parquet")

    assert scenes_of(tmp_path / "t.parquet").scene_ids.tolist() == ["v", "u"]


def test_text_that_is_not_text_is_refused(tmp_path: Path) -> None:
    broken = pa.array([b"\xff", b"b"]).view(pa.string())

    assert len(scenes_of(write(tmp_path / "unused.parquet", note=broken))) == 2
    with pytest.raises(InputError, match=r"t\.parquet is not a readable Parquet file: it is damaged"):
        scenes_of(write(tmp_path / "t.parquet", s=broken))


@pytest.mark.parametrize("content", [b"", b"PAR1", b"s,x\n1,2\n", b"PAR1" + bytes(100) + b"PAR1"])
def test_other_files_are_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "t.parquet").write_bytes(content)

    with pytest.raises(InputError, match=r"t\.parquet is not a readable Parquet file"):
        open_parquet(tmp_path / "t.parquet")
    with pytest.raises(InputError, match="stream is not a readable Parquet file"):
        parquet_from_bytes(content, "stream")


@pytest.mark.parametrize("buffered_from", [0, 2**20])
def test_blocks_have_the_rows_of_the_whole(
    buffered_from: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parquet_files, "_BUFFERED_FROM", buffered_from)
    path = write(tmp_path / "t.parquet", s=pa.array(["b", None]).dictionary_encode())
    file = parquet_files.parquet_at(path)
    blocks = list(file.blocks(["x", "s"], 1))

    assert [block.to_pydict() for block in blocks] == [{"x": [0.5], "s": ["b"]}, {"x": [1.5], "s": [None]}]
    assert pa.concat_tables(blocks).equals(file.load(["x", "s"]))
    assert file.types["s"] == blocks[0].schema.field("s").type


def test_damage_to_a_page_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "t.parquet"
    values = pa.table({"s": [0], "x": [0.1]})
    options = {"compression": "none", "use_dictionary": False, "write_statistics": False}
    parquet.write_table(values, path, write_page_checksum=True, **options)
    data = bytearray(path.read_bytes())
    data[data.index(np.float64(0.1).tobytes())] ^= 1
    path.write_bytes(data)

    with pytest.raises(InputError, match="is not a readable Parquet file"):
        scenes_of(path)


def test_a_small_file_does_not_unpack_to_any_size(tmp_path: Path) -> None:
    long = pa.DictionaryArray.from_arrays(np.zeros(1000, dtype=np.int32), ["x" * 1_000_000])
    parquet.write_table(pa.table({"s": long, "x": np.zeros(1000)}), tmp_path / "long.parquet")
    with pytest.raises(InputError, match=r"long\.parquet unpacks to 1000000000 bytes, more than 1000 t"):
        scenes_of(tmp_path / "long.parquet")

    parquet.write_table(pa.table({"s": np.zeros(40_000_000, dtype=np.int8)}), tmp_path / "many.parquet")
    with pytest.raises(InputError, match=r"many\.parquet unpacks to 320000000 bytes"):
        read_table(tmp_path / "many.parquet")


def test_a_folder_is_read_as_one_table(tmp_path: Path) -> None:
    write(tmp_path / "part-1.parquet", s=["c", "d"], x=[None, None])
    write(tmp_path / "part-0.pq")
    (tmp_path / "_SUCCESS").touch()
    (tmp_path / ".part-0.pq.crc").touch()

    assert scenes_of(tmp_path).scene_ids.tolist() == ["a", "b", "c", "d"]
    assert read_table(str(tmp_path), columns=["x"]).column("x").to_pylist() == [0.5, 1.5, None, None]


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({}, "folder .* contains no Parquet files"),
        (
            {"a.parquet": {}, "b.parquet": {"y": [1, 2]}},
            r"b\.parquet and .*a\.parquet differ in the column",
        ),
        (
            {"a.parquet": {}, "b.parquet": {"s": [1, 2]}},
            r"'s' contains int64 in .*b\.parquet, but large_str",
        ),
        ({"a.parquet": {}, "b.csv": {}}, r"contains 'b\.csv': only folders of Parquet files can be read"),
        ({"a.parquet": {}, "b.parquet": None}, r"b\.parquet is not a readable Parquet file"),
    ],
)
def test_files_of_a_folder_that_do_not_go_together_are_named(
    others: dict[str, dict[str, Any] | None], message: str, tmp_path: Path
) -> None:
    for name, columns in others.items():
        if columns is None:
            (tmp_path / name).touch()
        else:
            write(tmp_path / name, **columns)

    with pytest.raises(InputError, match=message):
        scenes_of(tmp_path)


def test_files_with_a_numbering_of_their_own_are_not_put_together(tmp_path: Path) -> None:
    write(tmp_path / "t.parquet")
    scenes_of(tmp_path / "t.parquet").to_parquet(tmp_path / "folder" / "own.parquet")

    with pytest.raises(InputError, match=r"own\.parquet was written by Scenes\.to_parquet: read such"):
        Scenes.from_parquet(tmp_path / "folder")
