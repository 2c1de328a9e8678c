# SPDX-License-Identifier: MIT
"""Ways to spoil files that only a program writes: checkpoints, traces and databases."""
import re
import sqlite3
import struct
import tempfile

import mutate


def rehashed(data, rng):
    """A checkpoint with a word changed whose last word, the hash of all before (model/base/hash.h), is right."""
    words = list(struct.unpack(f"<{len(data) // 8}Q", data[:len(data) // 8 * 8]))[:-1]
    for _ in range(rng.choice([1, 1, 2])):
        at = rng.randrange(len(words) if rng.random() < 0.5 else min(len(words), 30))
        words[at] = rng.choice([0, 1, 2**64 - 1, 2**63, 2**62, 2**32, words[at] + 1 & 2**64 - 1, words[at] ^ 1 << rng.randrange(64), 0x7ff8 << 48, 0x7ff0 << 48])
    if rng.random() < 0.2:
        words = words[:rng.randrange(len(words))]
    value, mask = 0, 2**64 - 1
    for word in words:
        z = (value ^ word) + 0x9e3779b97f4a7c15 & mask
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9 & mask
        z = (z ^ z >> 27) * 0x94d049bb133111eb & mask
        value = z ^ z >> 31
    return struct.pack(f"<{len(words) + 1}Q", *words, value)


def heads_of(data):
    """Where HDF5 has what it says of data: superblock, B-trees, heaps, symbol tables, and the object headers that those name."""
    places = [0] + [match.start() for match in re.finditer(rb"TREE|HEAP|SNOD|GCOL", data)]
    for table in [place for place in places if data[place:place + 4] == b"SNOD"]:
        for k in range(struct.unpack_from("<H", data, table + 6)[0]):
            places.append(struct.unpack_from("<Q", data, table + 8 + 40 * k + 8)[0])
    return [place for place in places if place < len(data) - 16]


def spoilt_heads(data, rng):
    """An HDF5 file that is spoilt where most bytes meet its reader: a byte, a word that says too much, another's address."""
    places, out = heads_of(data), bytearray(data)
    for _ in range(rng.choice([1, 1, 1, 2, 4])):
        at = min(rng.choice(places) + rng.randrange(rng.choice([24, 100, 400])), len(out) - 8)
        way = rng.choice(["bit", "byte", "word", "word", "address", "swap"])
        if way == "bit":
            out[at] ^= 1 << rng.randrange(8)
        elif way == "byte":
            out[at] = rng.choice([0, 1, 2, 3, 4, 8, 16, 127, 128, 255, rng.randrange(256)])
        elif way == "word":
            size = rng.choice([2, 4, 8])
            at -= at % size if rng.random() < 0.8 else 0
            top = 1 << 8 * size
            word = rng.choice([0, 1, top - 1, top >> 1, (top >> 1) - 1, len(data), len(data) - 1, rng.randrange(256), rng.randrange(top)]) % top
            out[at:at + size] = word.to_bytes(size, "little")
        elif way == "address":
            out[at:at + 8] = struct.pack("<Q", rng.choice(places))
        else:
            other = rng.choice(places)
            out[at - at % 8:at - at % 8 + 8] = data[other:other + 8]
    return bytes(out)


def spoilt_database(data, rng):
    """By bytes, or by SQL: then the file is sound and what stands in it is not."""
    if rng.random() < 0.5:
        return mutate.spoil(data, rng, mutate.BYTES)
    with tempfile.NamedTemporaryFile(suffix=".db") as file:
        file.write(data)
        file.flush()
        base = sqlite3.connect(file.name, isolation_level=None)
        base.execute("PRAGMA journal_mode = DELETE")
        tables = sorted(row[0] for row in base.execute("SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite%'"))
        table = rng.choice(tables)
        columns = sorted(row[1] for row in base.execute(f'PRAGMA table_info("{table}")'))
        value = rng.choice(["NULL", "'text'", "-1", "1e308", "9223372036854775807", "x'00ff'", "''", "'{'", "'[[[['", "'{\"a\": 1}'", "'[]'", "'null'",
                            "'[1e999]'", "zeroblob(100000)", "0.5", "9e999"])
        way = rng.choice(["value", "value", "value", "value", "drop", "rename", "column", "version", "rows", "more"])
        column = rng.choice(columns)
        statement = {
            "value": f'UPDATE OR IGNORE "{table}" SET "{column}" = {value}', "drop": f'DROP TABLE "{table}"',
            "rename": f'ALTER TABLE "{table}" RENAME COLUMN "{column}" TO other', "column": f'ALTER TABLE "{table}" ADD COLUMN more TEXT',
            "version": f"PRAGMA user_version = {rng.choice([0, 1, 7, 99999, -1])}", "rows": f'DELETE FROM "{table}"',
            "more": f'INSERT OR IGNORE INTO "{table}" ("{column}") VALUES ({value})'}[way]
        try:
            base.execute(statement)
        except sqlite3.Error:
            base.execute("PRAGMA user_version = 12345")
        base.close()
        file.seek(0)
        with open(file.name, "rb") as changed:
            return changed.read(), ["SQL " + way]
