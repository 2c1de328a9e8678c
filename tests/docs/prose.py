#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Holds the prose of the pages: a sentence has at most 30 words, a line at most 160 columns.

    prose.py ROOT [PAGE...]    prints what is longer, as PAGE:LINE: ...; exit status 1 if there is any

Tables, code, comments, pictures and links' targets are no prose, nor is what a script wrote: docs/tables and
tests/blocks/pages. A span of code is one word."""
import pathlib
import re
import sys

WORDS, COLUMNS = 30, 160
END = re.compile(r"(?<!\.\.\.)(?<!e\.g\.)(?<!i\.e\.)(?<!et al\.)(?<!cf\.)(?<=[.!?])[\"')\]*_]*\s+(?=[\w`\"'(*\[√])")


class Paragraph:
    """Consecutive lines of prose, from line `first` on, counted from 0."""

    def __init__(self, first, indent, lead):
        self.first, self.indent, self.lead, self.lines = first, indent, lead, []

    def text(self):
        return " ".join(line.strip() for line in self.lines)


def paragraphs(text):
    """The paragraphs of a page; `lead` is what begins one that is an item of a list."""
    found, current, fence, comment, generated, blank = [], None, "", False, False, True
    for number, line in enumerate(text.split("\n")):
        bare = line.strip()
        item = re.match(r"( *)([-*]|\d+\.) +(?=\S)", line)
        if fence:
            fence = "" if bare == fence else fence
        elif re.match(r"```|~~~", bare):
            fence, current = bare[:3], None
        elif generated or re.match(r"<!-- (module|proofs|pages|table)\b", bare):
            generated, current = bare != "<!-- end -->", None
        elif comment or bare.startswith("<!--"):
            comment, current = "-->" not in bare, None
        elif not bare or bare[0] in "|#<" or bare.startswith("!["):
            current = None
        elif blank and line.startswith("    ") and not (item or (found and found[-1].lead and current)):
            current = None  # code by indentation
            continue
        elif item:
            current = Paragraph(number, len(item[0]), item[0])
            current.lines.append(line[len(item[0]):])
            found.append(current)
        elif current is not None:
            current.lines.append(line)
        elif not line.startswith("    "):
            current = Paragraph(number, len(line) - len(line.lstrip()), "")
            current.lines.append(line)
            found.append(current)
        blank = not bare
    return found


def masked(text):
    """The text at its length, with what is no prose as a word or as blanks."""
    text = re.sub(r"`[^`]+`", lambda m: "`" + "c" * (len(m[0]) - 2) + "`", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", lambda m: " " * len(m[0]), text)
    return re.sub(r"\]\([^)]*\)", lambda m: "]" + " " * (len(m[0]) - 1), text)


def sentences(text):
    """(begin, end) of each sentence."""
    mask, begin, found = masked(text), 0, []
    for match in END.finditer(mask):
        found.append((begin, match.start() + len(match[0].rstrip())))
        begin = match.end()
    return found + [(begin, len(text))]


def words(sentence):
    return sum(bool(re.search(r"\w", word)) for word in masked(sentence).split())


def pages(root):
    return [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")] + sorted((root / "docs").rglob("*.md"))


def main(root, only):
    bad = count = 0
    for page in only or pages(root):
        for paragraph in paragraphs(page.read_text()):
            text = paragraph.text()
            for begin, end in sentences(text):
                count += 1
                length = words(text[begin:end])
                if length > WORDS:
                    print(f"{page}:{paragraph.first + 1}: {length} words, more than {WORDS}: {text[begin:end]}")
                    bad += 1
            for number, line in enumerate(paragraph.lines, paragraph.first + 1):
                if len(line) > COLUMNS:
                    print(f"{page}:{number}: {len(line)} columns, more than {COLUMNS}")
                    bad += 1
    if not only and count < 2000:
        print(f"only {count} sentences found: the check sees nothing")
        bad += 1
    print(f"{count} sentences, {bad} too long" if bad else f"{count} sentences, none too long")
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(pathlib.Path(sys.argv[1]), [pathlib.Path(page) for page in sys.argv[2:]]))
