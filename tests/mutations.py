"""Ways to damage a file, or to make a hostile one of it, drawn from a random generator."""

from __future__ import annotations

import copy
import gzip
import io
import json
import warnings
import zipfile
import zlib
from collections.abc import Callable
from typing import Any, Final

import numpy as np

Mutation = Callable[[bytes, np.random.Generator], bytes]

HOSTILE_VALUES: Final[tuple[Any, ...]] = (
    None,
    True,
    0,
    -1,
    1,
    2**31,
    2**53 + 1,
    2**63,
    -(2**63) - 1,
    10**99,
    10**400,
    0.5,
    -0.0,
    1e-320,
    1e30,
    -1e40,
    1e100,
    1e308,
    float("nan"),
    float("inf"),
    "",
    "1",
    "nan",
    "id",
    "location",
    "\x00",
    "a\nb",
    "\x1b[31m",
    "\ud800",
    "\N{CJK UNIFIED IDEOGRAPH-4E2D}",
    "../../etc/passwd",
    "x" * 300,
    [],
    {},
    [[]],
    [None],
    [1, "a"],
    [0.5] * 1000,
    {"kind": "leaf"},
)
HOSTILE_FIELDS: Final = (
    "",
    "nan",
    "NA",
    "?",
    "inf",
    "1e999",
    "-1e40",
    "0x10",
    "007",
    "1_000",
    "2020-01-01",
    "9" * 40,
    "9007199254740993",
    "true",
    "'",
    '"',
    '""',
    "a b",
    "é",
    "\x00",
    "\r",
    "\N{CJK UNIFIED IDEOGRAPH-4E2D}",
    "{a,b}",
    "%",
    "@data",
    "x" * 300,
)


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Damage bytes, as a disk or a transfer does: flips, cuts, holes, repetitions, foreign bytes."""
    buffer = bytearray(data)
    for _ in range(_count(rng)):
        begin, end = sorted(rng.integers(0, len(buffer) + 1, size=2).tolist())
        end = min(end, begin + int(rng.integers(1, 64)))
        match int(rng.integers(8)):
            case 0 if buffer:
                buffer[int(rng.integers(len(buffer)))] ^= 1 << int(rng.integers(8))
            case 1:
                del buffer[begin:]
            case 2:
                del buffer[begin:end]
            case 3:
                buffer[begin:begin] = buffer[begin:end]
            case 4:
                buffer[begin:end] = bytes(end - begin)
            case 5:
                buffer[begin:end] = rng.bytes(end - begin)
            case 6:
                buffer[begin:begin] = rng.bytes(int(rng.integers(1, 9)))
            case _:
                place = int(rng.integers(len(buffer) + 1))
                buffer[place:place] = buffer[begin:end]
    return bytes(buffer)


def with_other_fields(data: bytes, rng: np.random.Generator) -> bytes:
    """Replace, repeat or drop fields and lines of a text that holds a table."""
    text = data.decode("utf-8", "replace")
    for _ in range(_count(rng)):
        lines = text.split("\n")
        number = int(rng.integers(len(lines)))
        fields = lines[number].split(",")
        place = int(rng.integers(len(fields)))
        match int(rng.integers(6)):
            case 0:
                lines.insert(number, lines[int(rng.integers(len(lines)))])
            case 1:
                del lines[number]
            case 2:
                fields.insert(place, _field(rng))
            case 3:
                del fields[place]
            case _:
                fields[place] = _field(rng)
        if number < len(lines):
            lines[number] = ",".join(fields)
        text = "\n".join(lines)
    if rng.random() < 0.1:
        text = text.replace(",", ";")
    encoding = "utf-16" if rng.random() < 0.02 else "latin-1" if rng.random() < 0.05 else "utf-8"
    return text.encode(encoding, "replace")


def with_other_values(data: bytes, rng: np.random.Generator) -> bytes:
    """Change values of a JSON document: other numbers, types, keys, orders and depths."""
    document = json.loads(data)
    for _ in range(_count(rng)):
        document = _changed(document, rng)
    return json.dumps(document).encode()


def with_other_arrays(data: bytes, rng: np.random.Generator) -> bytes:
    """Change numbers, types, shapes and headers inside an archive whose checksums are right again."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    for _ in range(int(rng.integers(1, 3))):
        names = sorted(members)
        name = names[int(rng.integers(len(names)))]
        match int(rng.integers(5)):
            case 0:
                members[name] = damaged(members[name], rng)
            case 1:
                begin = int(rng.integers(min(128, len(members[name]))))
                members[name] = members[name][:begin] + rng.bytes(1) + members[name][begin + 1 :]
            case 2:
                members[name] = members[names[int(rng.integers(len(names)))]]
            case 3:
                del members[name]
                if not members:
                    break
            case _:
                members[name] = _npy(rng)
    packing = zipfile.ZIP_STORED if rng.random() < 0.8 else int(rng.choice([8, 12, 14]))
    buffer = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(buffer, "w", packing) as archive:
        warnings.simplefilter("ignore")
        for name, content in members.items():
            archive.writestr(name, content)
    return damaged(buffer.getvalue(), rng) if rng.random() < 0.2 else buffer.getvalue()


def inside_gzip(mutation: Mutation) -> Mutation:
    """Return a mutation of what a gzip file holds; sometimes of the file itself."""

    def mutate(data: bytes, rng: np.random.Generator) -> bytes:
        if rng.random() < 0.3:
            return damaged(data, rng)
        return gzip.compress(mutation(gzip.decompress(data), rng), mtime=0)

    return mutate


def either(*mutations: Mutation) -> Mutation:
    """Return a mutation that is one of several."""

    def mutate(data: bytes, rng: np.random.Generator) -> bytes:
        return mutations[int(rng.integers(len(mutations)))](data, rng)

    return mutate


def case_generator(name: str, seed: int, number: int) -> np.random.Generator:
    """Return the random generator of one numbered case of a named format."""
    return np.random.default_rng([seed, zlib.crc32(name.encode()), number])


def _count(rng: np.random.Generator) -> int:
    """Return how many changes to make: often one, which leaves most of a file in order."""
    return 1 if rng.random() < 0.7 else int(rng.integers(2, 4))


def _field(rng: np.random.Generator) -> str:
    return HOSTILE_FIELDS[int(rng.integers(len(HOSTILE_FIELDS)))]


def _value(rng: np.random.Generator) -> Any:
    if rng.random() < 0.02:
        nested: Any = 0
        # No deeper than the encoder of the standard library can write.
        for _ in range(int(rng.integers(50, 200))):
            nested = [nested]
        return nested
    return copy.copy(HOSTILE_VALUES[int(rng.integers(len(HOSTILE_VALUES)))])


def _changed(document: Any, rng: np.random.Generator) -> Any:
    holders: list[Any] = []
    pending = [document]
    while pending and len(holders) < 5000:
        value = pending.pop()
        if isinstance(value, (dict, list)) and value:
            holders.append(value)
            pending.extend(value.values() if isinstance(value, dict) else value)
    if not holders:
        return _value(rng)
    holder = holders[int(rng.integers(len(holders)))]
    keys = list(holder) if isinstance(holder, dict) else list(range(len(holder)))
    key, other = keys[int(rng.integers(len(keys)))], keys[int(rng.integers(len(keys)))]
    value = holder[key]
    if isinstance(value, (int, float)) and not isinstance(value, bool) and rng.random() < 0.7:
        holder[key] = _near(value, rng)
        return document
    match int(rng.integers(6)):
        case 0:
            del holder[key]
        case 1:
            holder[key], holder[other] = holder[other], holder[key]
        case 2 if isinstance(holder, dict):
            holder[str(_value(rng))[:50]] = holder.pop(key)
        case 2:
            holder.insert(key, copy.deepcopy(holder[other]))
        case 3 if isinstance(holder, list):
            holder.extend(copy.deepcopy(holder[: int(rng.integers(1, 50))]))
        case _:
            holder[key] = _value(rng)
    return document


def _near(number: float, rng: np.random.Generator) -> float:
    """Return another number of the same type, close or far."""
    if isinstance(number, int):
        return number + int(rng.integers(-3, 4))
    return number * float(rng.choice([-1.0, 0.0, 0.5, 0.999, 2.0, 1e10, 1e-10, 1e35, 1e-60, 1e300]))


def _npy(rng: np.random.Generator) -> bytes:
    """Return the bytes of an array of any type, shape and numbers."""
    dtypes = ["f8", ">f8", "f4", "f2", "i8", "i4", "u1", "?", "c16", "U3", "M8[s]", "S2", "i4,f8"]
    dtype = dtypes[int(rng.integers(len(dtypes)))]
    shape = tuple(rng.integers(0, 5, size=int(rng.integers(4))).tolist())
    array = np.zeros(shape, dtype=dtype)
    if dtype in {"f8", "i8"} and array.size:
        choices = (
            [0, 1, -1, 3, 2**62, -(2**63)] if dtype == "i8" else [0.0, -1.0, np.nan, np.inf, 1e300, 1e30]
        )
        array[...] = np.array(choices, dtype=dtype)[rng.integers(len(choices), size=shape)]
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, array, allow_pickle=False)
    return buffer.getvalue()
