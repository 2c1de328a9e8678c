#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The benchmark around the engines themselves, compiled for the host: each arithmetic gives a row whose counters fit its
# scene. usage: bench_host.sh cuboct-gpu-host
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$1" bench --only block_256k --quick --settle 1 --repeats 1 --seconds 0.001 --devices 0,1 --json "$scratch/json" >"$scratch/out"
fail() {
  echo "$1"
  cat "$scratch/out" "$scratch/json"
  exit 1
}
[ "$(wc -l <"$scratch/json")" = 4 ] || fail "not a line for the machine and each of three rows"
for arithmetic in float double fixed; do
  row=$(grep "^{\"row\":\"block_256k.$arithmetic\",\"arithmetic\":\"$arithmetic\",\"particles\":256000," "$scratch/json") ||
    fail "no row of $arithmetic"
  # Inside the cutoff are 12 first and 6 second neighbours; a wide skin holds the 24 third ones too. Less at the surface.
  longest=$(sed -E 's/.*"longest_list":([0-9]+).*/\1/' <<<"$row")
  [ "$longest" = 18 ] || [ "$longest" = 42 ] || fail "$longest partners of a particle"
  pairs=$(sed -E 's/.*"listed_pairs":([0-9.]+).*/\1/' <<<"$row")
  awk -v pairs="$pairs" -v longest="$longest" 'BEGIN { exit !(pairs > 0.9 * longest && pairs < longest) }' ||
    fail "$pairs partners of a particle"
  grep -Eq '"halo_particles":[1-9]' <<<"$row" || fail "no halo between two slabs"
  grep -Eq '"golden_steps":0,' <<<"$row" || fail "steps of another engine"
done
echo "$(grep -c '"row"' "$scratch/json") rows"
