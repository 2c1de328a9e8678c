#!/bin/sh
# SPDX-License-Identifier: MIT
# The pages become HTML, every link of which leads somewhere; the search's index knows the pages.
# usage: site.sh ROOT MKDOCS; exit status 77 where there is no mkdocs
set -eu
if ! [ -x "$2" ]; then
  echo "skipped: mkdocs (Debian package mkdocs) is not found"
  exit 77
fi
MKDOCS=$2 "$1/docs/site.py" work site
grep -q '"location":"docs/overview.html"' site/search/search_index.json
grep -q 'src="images/flow.svg"' site/docs/overview.html
test -s site/docs/images/flow.svg
echo "$(find site -name '*.html' | wc -l) pages"
