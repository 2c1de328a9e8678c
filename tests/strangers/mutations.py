# SPDX-License-Identifier: MIT
"""Damaged copies of files: what a disk, an editor or an enemy makes of them."""
import random
import re

EXTREMES = [b"-1", b"0", b"1e39", b"-1e300", b"nan", b"inf", b"4294967295", b"2147483648", b"99999999999999999999", b"65536"]
NUMBER = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def flip(data, dice):
    data = bytearray(data)
    for _ in range(dice.choice([1, 1, 2, 8])):
        data[dice.randrange(len(data))] = dice.choice([dice.randrange(256), 0, 255])
    return bytes(data)


def cut(data, dice):
    return data[: dice.randrange(len(data))]


def leave_out(data, dice):
    at = dice.randrange(len(data))
    return data[:at] + data[at + dice.choice([1, 2, 4, 50]) :]


def repeat(data, dice):
    at = dice.randrange(len(data))
    return data[:at] + data[at : at + dice.choice([1, 4, 100])] * dice.choice([2, 50]) + data[at:]


def number(data, dice):
    numbers = list(NUMBER.finditer(data))
    if not numbers:
        return flip(data, dice)
    at = dice.choice(numbers)
    return data[: at.start()] + dice.choice(EXTREMES) + data[at.end() :]


def word(data, dice):
    """Four bytes of a binary file: a count, a size, an address."""
    at = dice.randrange(max(1, len(data) - 4))
    value = dice.choice([0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0, 1, dice.randrange(1 << 32)])
    return data[:at] + value.to_bytes(4, "little") + data[at + 4 :]


def mutate(data, seed):
    dice = random.Random(seed)
    for _ in range(dice.choice([1, 1, 1, 3])):
        data = dice.choice([flip, cut, leave_out, repeat, number, number, word])(data, dice) or b"\0"
    return data
