# SPDX-License-Identifier: MIT
# mkdocs calls this: anchors of headings as GitHub makes them, and every anchor that a link names is there.
import logging
import pathlib
import re
import urllib.parse

log = logging.getLogger("mkdocs.plugins.anchors")


def slugify(heading, separator):
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def on_config(config):
    config["mdx_configs"]["toc"]["slugify"] = slugify
    return config


def on_post_build(config):
    site = pathlib.Path(config["site_dir"])
    texts = {page: page.read_text() for page in site.rglob("*.html")}
    ids = {page: set(re.findall(r'\bid="([^"]+)"', text)) for page, text in texts.items()}
    count = 0
    for page, text in texts.items():
        if "mkdocs" not in text or page.name == "404.html":  # a file of the tree, such as a study; served anywhere
            continue
        plain = re.sub(r"<pre>.*?</pre>", "", text, flags=re.S)
        for line in re.findall(r"^(?:<p>)?(?:[-*] |\| |```).*", plain, re.M):
            log.warning(f"{page.relative_to(site)}: read as text: {line[:80]}")
        for target in re.findall(r'(?:href|src)="([^"]+)"', text):
            if re.match(r"[a-z]+:|//", target) or target == "#":
                continue
            path, _, anchor = urllib.parse.unquote(target).partition("#")
            to = (page.parent / path).resolve() if path else page
            count += 1
            if not to.exists():
                log.warning(f"{page.relative_to(site)}: no file {target}")
            elif anchor and to in ids and anchor not in ids[to]:
                log.warning(f"{page.relative_to(site)}: no anchor {target}")
    if count < 1000:
        log.warning(f"only {count} links were looked at: the check sees nothing")
