#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A target that takes more than twice its share of the build's CPU seconds is seen (docs/build_table check).
# usage: budget.sh ROOT [measure]; `measure` builds the demo's programs anew, without ccache, and holds them against
# docs/measured/data/build-cost.tsv.
set -euo pipefail
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [[ ${2-} == measure ]]; then
  git -C "$root" worktree add -q --detach "$work/tree"
  trap 'git -C "$root" worktree remove --force "$work/tree"; rm -rf "$work"' EXIT
  "$root/docs/build_table" measure --only cuboct,cuboct-systemc,cuboct-rtl,cuboct-study,cuboct-machine,cuboct-bench "$work/tree" > "$work/results"
  "$root/docs/build_table" check "$work/results"
  exit
fi
printf '# commit: 0\nCPU seconds of\t0\t1\nthe whole build\t900\t1000\n`rules`\t9\t100\n`engine`\t1\t400\nlinks\t2\t500\n' > "$work/table"
results() { printf '{"targets": {"rules": %s, "engine": 800, "links": 1000, "small": 15}}\n' "$1"; }
results 390 > "$work/within"
"$root/docs/build_table" check "$work/within" --table "$work/table"
results 560 > "$work/beyond"
if said=$("$root/docs/build_table" check "$work/beyond" --table "$work/table"); then
  echo "a target with more than twice its share was not seen: $said"
  exit 1
fi
diff - <(echo "$said") <<< "rules: 23.6 % of the build's CPU seconds; the table has 10.0 %"
