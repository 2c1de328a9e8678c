#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the HTML of README.md and docs/ with mkdocs.

    docs/site.py WORK OUT

The tree's own links lead out of docs/, so mkdocs gets a copy of all pages, at their paths, with every file that a page
links to. Headings get the anchors that GitHub gives them. A link to what is not there ends the build: exit status 1."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = pathlib.Path(__file__).resolve().parent
SHELVES = (("How to", "user"), ("Contract", "reference"), ("Measured", "measured"))
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")


def linked(page):
    """The files of the tree that a page links to."""
    for target in LINK.findall(page.read_text()):
        path = (page.parent / target).resolve()
        if not re.match(r"https?:|mailto:", target) and path.is_file() and path.is_relative_to(ROOT):
            yield path


def with_lists(text):
    """As mkdocs' Markdown reads lists: after an empty line, and four blanks deeper where GitHub takes two."""
    lines, fence, inside, before = [], False, False, ""
    for line in text.split("\n"):
        indent = len(line) - len(line.lstrip(" "))
        item = re.match(r" *([-*]|\d+\.) ", line)
        fence ^= line.lstrip().startswith("```")
        if not fence and item and (inside or indent == 0):
            if not inside and before:
                lines.append("")
            inside = True
        elif inside and not fence and line and not indent and not before:
            inside = False
        lines.append(" " * indent + line if inside and not fence else line)
        before = line.strip()
    return "\n".join(lines)


def copy(path, into):
    to = into / path.relative_to(ROOT)
    to.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".md":
        to.write_text(with_lists(path.read_text()))
    else:
        shutil.copyfile(path, to)


def title(page):
    return re.search(r"^# (.*)$", page.read_text(), re.M)[1].replace("`", "")


def navigation(pages):
    entry = lambda page: {title(page): str(page.relative_to(ROOT))}
    inside = lambda folder: [entry(p) for p in pages if p.parent == HERE / folder]
    nav = [{"Start": "README.md"}, {"Pages": "docs/README.md"}, {"Overview": "docs/overview.md"},
           {"Words": "docs/glossary.md"}]
    nav += [{name: inside(folder)} for name, folder in SHELVES]
    nav.append({"Blocks": inside("reference/blocks")})
    about = (HERE / "developer.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md")
    nav.append({"Developers": [entry(page) for page in about]})
    return nav


def main(work, out):
    source = work / "source"
    shutil.rmtree(source, ignore_errors=True)
    pages = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")] + sorted(HERE.rglob("*.md"))
    for page in pages:
        copy(page, source)
        for path in linked(page):
            copy(path, source)
    for name in ("site.css", "site_hook.py"):
        shutil.copyfile(HERE / name, (source if name.endswith("css") else work) / name)
    config = work / "mkdocs.yml"  # JSON is YAML
    config.write_text(json.dumps({
        "site_name": "cuboct", "docs_dir": str(source), "site_dir": str(out), "use_directory_urls": False,
        "theme": {"name": "mkdocs", "highlightjs": False, "nav_style": "light"}, "extra_css": ["site.css"],
        "plugins": ["search"], "hooks": [str(work / "site_hook.py")], "nav": navigation(pages),
        "markdown_extensions": ["tables", "fenced_code", "sane_lists", {"toc": {"permalink": True}}]}))
    mkdocs = os.environ.get("MKDOCS", "mkdocs").split()
    return subprocess.run([*mkdocs, "build", "--quiet", "--strict", "--clean", "-f", str(config)]).returncode


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    work = pathlib.Path(sys.argv[1]).resolve()
    work.mkdir(parents=True, exist_ok=True)
    sys.exit(main(work, pathlib.Path(sys.argv[2]).resolve()))
