#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every link of the pages leads to a file of the tree, and to a heading that is there; docs/README.md maps every page.

    links.py ROOT    prints each that does not, as PAGE:LINE: ...; exit status 1 if there is any"""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from prose import pages  # noqa: E402


def without_code(text):
    text = re.sub(r"^```.*?^```", lambda m: "\n" * m[0].count("\n"), text, flags=re.S | re.M)
    return re.sub(r"`[^`\n]*`", lambda m: m[0].replace("[", "("), text)


def anchors(page):
    """Of the headings, as GitHub makes them: lower case, blanks as hyphens, a number behind the second of a kind."""
    found, seen = set(), {}
    for heading in re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.S | re.M), re.M):
        name = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
        name = re.sub(r"[^\w\- ]", "", name).replace(" ", "-")
        found.add(name if name not in seen else f"{name}-{seen[name]}")
        seen[name] = seen.get(name, 0) + 1
    return found


def main(root):
    bad, mapped, count = [], set(), 0
    root = root.resolve()
    for page in pages(root):
        text = without_code(page.read_text())
        for match in re.finditer(r"\[[^\]]*\]\(([^)\s]+)\)", text):
            if re.match(r"https?:|mailto:", match[1]):
                continue
            count += 1
            path, _, anchor = match[1].partition("#")
            to = (page.parent / path).resolve() if path else page
            place = f"{page.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}"
            if not to.exists():
                bad.append(f"{place}: no file {match[1]}")
            elif anchor and anchor not in anchors(to):
                bad.append(f"{place}: no heading {match[1]}")
            if page == root / "docs/README.md":
                mapped.add(to)
    blocks = root / "docs/reference/blocks"
    for page in pages(root)[1:]:
        if page not in mapped and page.parent != blocks and page != root / "docs/README.md":
            bad.append(f"docs/README.md: does not map {page.relative_to(root)}")
    if count < 400:
        bad.append(f"only {count} links found: the check sees nothing")
    print("\n".join(bad + [f"{count} links, {len(bad)} wrong"]))
    return 1 if bad else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(pathlib.Path(sys.argv[1])))
