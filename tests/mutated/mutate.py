# SPDX-License-Identifier: MIT
"""Ways to spoil a file. Each takes its bytes and a random.Random, and returns other bytes."""
import re

NUMBER = re.compile(rb"(?<![\w.#])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
QUOTED = re.compile(rb'"[^"\n]*"')
ASSIGNED = re.compile(rb"^([ \t]*[\w.]+[ \t]*=[ \t]*)(.+)$", re.MULTILINE)
WORD = re.compile(rb"[A-Za-z_]{2,}")

NUMBERS = [b"0", b"-1", b"1", b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-308", b"5e-324", b"-0.0", b"0.5", b"3", b"1e10", b"1e-10",
           b"2147483647", b"4294967296", b"9223372036854775807", b"-9223372036854775808", b"18446744073709551616", b"9" * 400, b"0x7f",
           b"1_000", b"00", b"1e999", b"1e3", b"-7", b"255", b"65536"]
UNITS = [b"mm", b"m", b"kg", b"MPa", b"1/s", b"GPa", b"eV", b"furlong", b"m/m/m", b"", b"m^999999999999", b"/", b"mm mm", b"%", b"ps"]
VALUES = [b'"text"', b"[]", b"{}", b"[[]]", b"true", b"false", b"0", b"-1", b"1979-05-27T07:32:00Z", b"07:32:00", b'"""\nlines\n"""', b"'raw'",
          b"[1, [2], \"3\"]", b"{ a = 1 }", b'""', b'" "', b"[0, 0, 0]", b'"[0, 0, 0] mm"', b'"[1, 2] m"', b'"-5 mm"', b'"nan mm"', b'"1e400 m"',
          b"[nan, inf, 0]", b'"x"', b'"\\u0000"', b'"\\u001b[31mred\\u202e"', b'"a\\nb"', b'["x", "x"]', b"1e308", b"9223372036854775807"]
PATHS = [b"/dev/null", b"/", b".", b"..", b"missing.file", b"/dev/full", b"/etc/passwd", b"", b"a\\u0000b", b"x" * 5000, b"in"]


def some_match(pattern, data, rng):
    found = list(pattern.finditer(data))
    return rng.choice(found) if found else None


def put(data, match, text, group=0):
    return data[:match.start(group)] + text + data[match.end(group):]


def lines_changed(change):
    def spoil(data, rng):
        lines = data.split(b"\n")
        return b"\n".join(change(lines, rng.randrange(len(lines)), rng))
    return spoil


def matched(pattern, texts, group=0, between=b"%s"):
    def spoil(data, rng):
        match = some_match(pattern, data, rng)
        return put(data, match, between.replace(b"%s", rng.choice(texts)), group) if match else data + rng.choice(texts)
    return spoil


def flip(data, rng):
    out = bytearray(data or b"\0")
    # Half of the time near the beginning, where formats have their heads.
    end = len(out) if rng.random() < 0.5 else min(len(out), 600)
    for _ in range(rng.choice([1, 1, 2, 4, 16])):
        out[rng.randrange(end)] ^= rng.randrange(1, 256)
    return bytes(out)


def truncated(data, rng):
    return data[:rng.randrange(len(data) + 1)]


def overwritten(data, rng):
    """A word where a format may have a count, an offset or a type."""
    size = rng.choice([1, 2, 4, 8])
    if len(data) < size:
        return data + b"\xff" * size
    end = len(data) - size + 1
    at = rng.randrange(end if rng.random() < 0.5 else min(end, 1024))
    at -= at % size
    word = rng.choice([b"\xff" * size, b"\0" * size, b"\x7f".rjust(size, b"\xff"), b"\x01".ljust(size, b"\0"), b"\x80".rjust(size, b"\0")])
    return data[:at] + word + data[at + size:]


def block_moved(data, rng):
    if len(data) < 4:
        return data * 3
    a, b = sorted(rng.randrange(len(data)) for _ in range(2))
    block, rest = data[a:b], data[:a] + data[b:]
    at = rng.randrange(len(rest) + 1)
    return rng.choice([rest, rest[:at] + block + rest[at:], data[:b] + block + data[b:], data[:a] + b"\0" * (b - a) + data[b:]])


def grown(data, rng):
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.randbytes(rng.choice([1, 8, 64, 5000])) + data[at:]


def empty(data, rng):
    return rng.choice([b"", b"\n", b"\0", b"\0" * 4096, b" "])


def nested(data, rng):
    deep = rng.choice([50, 1000, 100000])
    text = rng.choice([b"[" * deep, b"[" * deep + b"]" * deep, b"{a=" * deep + b"1" + b"}" * deep, b"a." * deep + b"a"])
    match = some_match(ASSIGNED, data, rng)
    return put(data, match, text, 2) if match else data + text


def long_text(data, rng):
    text = rng.choice([b"x", b"\xc3\xa4", b"0", b" ", b"a,"]) * rng.choice([300, 5000, 200000])
    match = some_match(QUOTED, data, rng)
    if match and rng.random() < 0.8:
        return put(data, match, b'"' + text + b'"')
    at = rng.randrange(len(data) + 1)
    return data[:at] + text + data[at:]


def scaled(data, rng):
    """A number that may still make sense."""
    match = some_match(NUMBER, data, rng)
    if not match:
        return data
    try:
        number = float(match.group()) * rng.choice([0.1, 0.5, 0.9, 1.1, 2, 3, 10, -1]) + rng.choice([0, 0, 0, 1, -1])
    except ValueError:
        return data
    return put(data, match, b"%g" % number)


def encoded(data, rng):
    text = data.decode("utf-8", "replace")
    return rng.choice([lambda: b"\xef\xbb\xbf" + data, lambda: text.encode("utf-16"), lambda: text.encode("utf-16-be"),
                       lambda: data.replace(b"e", b"\xe9", rng.randrange(1, 5)), lambda: text.encode("utf-32"),
                       lambda: data.replace(b"\n", b"\r\n"), lambda: data.replace(b"\n", b"\r")])()


def controls(data, rng):
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.choice([b"\0", b"\x1b[2J", b"\x07", b"\x7f", b"\xc2\x9b31m", b"\xe2\x80\xae", b"\x08", b"\xff\xfe", b"\xf8"]) + data[at:]


def misspelt(data, rng):
    match = some_match(WORD, data, rng)
    if not match:
        return data
    word = bytearray(match.group())
    at = rng.randrange(len(word))
    return put(data, match, rng.choice([bytes(word[:at] + word[at + 1:]), bytes(word) + b"s", bytes(word).upper(), bytes(word[::-1])]))


def united(data, rng):
    """A quantity with another unit: "0.5 kg"."""
    match = some_match(QUOTED, data, rng)
    if not match:
        return data
    number = NUMBER.search(match.group())
    return put(data, match, b'"' + (number.group() if number else b"1") + b" " + rng.choice(UNITS) + b'"')


def spliced(other):
    def spoil(data, rng):
        """Some lines of another file of the same kind."""
        lines, more = data.split(b"\n"), other.split(b"\n")
        at, begin = rng.randrange(len(lines)), rng.randrange(len(more))
        return b"\n".join(lines[:at] + more[begin:begin + rng.choice([1, 3, 10, len(more)])] + lines[at + rng.choice([0, 1]):])
    return spoil


BYTES = {"flip": flip, "truncate": truncated, "overwrite": overwritten, "block": block_moved, "grow": grown, "empty": empty}

TEXT = {
    "flip": flip, "truncate": truncated, "grow": grown, "empty": empty,
    "line_gone": lines_changed(lambda lines, k, rng: lines[:k] + lines[k + 1:]),
    "line_twice": lines_changed(lambda lines, k, rng: lines[:k + 1] + lines[k:]),
    "lines_swapped": lines_changed(lambda lines, k, rng: lines[k:k + 1] + lines[:k] + lines[k + 1:]),
    "number": matched(NUMBER, NUMBERS), "scaled": scaled, "encoding": encoded, "controls": controls, "long": long_text, "misspelt": misspelt,
}

# Of configuration: what holds the syntax comes oftener, as it gets further.
TOML = TEXT | {"value": matched(ASSIGNED, VALUES, 2), "unit": united, "nested": nested,
               "string": matched(QUOTED, PATHS, 0, b'"%s"'), "word": matched(QUOTED, [b'"' + w + b'"' for w in (
                   b"x", b"lj", b"elastic", b"box", b"sphere", b"mesh", b"auto", b"relaxed", b"xyz", b"left", b"all", b"tersoff", b"lps")])}
WEIGHTS = {"number": 10, "scaled": 10, "value": 8, "unit": 5, "word": 3, "line_gone": 4, "line_twice": 2, "misspelt": 2, "splice": 3, "empty": 0.5, "truncate": 2}


def spoil(data, rng, ways):
    """The changed bytes and the names of the ways that changed them."""
    names = list(ways)
    weights = [WEIGHTS.get(name, 1) for name in names]
    taken = rng.choices(names, weights, k=rng.choice([1, 1, 1, 1, 2, 3]))
    for name in taken:
        data = ways[name](data, rng)
    return data, taken
