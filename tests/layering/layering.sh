#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What each folder may include besides itself and model; rooms of model in the order of the list. "folder/." is the folder
# without those below it.
# usage: layering.sh ROOT; prints each forbidden include and fails if there is one.
set -euo pipefail
cd "$1"

# The machine and its engines know no atoms.
machine="model/base model/config model/graph model/contract model/body model/rules model/program model/solid model/real model/scene model/trace
  model/analysis model/run"
declare -A may=(
  [model/base]=""
  [model/config]="model/base"
  [model/graph]="model/base"
  [model/contract]="model/base model/graph"
  [model/body]="model/base model/config model/contract"
  [model/atoms/bond_order]="model/base"
  [model/atoms/coarse]="model/base"
  [model/rules]="model/base model/contract model/atoms/bond_order"
  [model/program]="model/base model/graph model/contract model/rules"
  [model/solid]="model/base model/contract"
  [model/real]="model/base model/contract model/rules"
  [model/scene]="model/base model/config model/body model/contract model/rules model/program model/solid model/atoms/bond_order"
  [model/trace]="model/base model/config model/contract model/scene"
  [model/analysis]="model/base model/body model/contract model/rules model/program model/solid model/real model/scene model/trace"
  [model/mesh]="model/base model/body"
  [model/atoms/multiscale]="model/base model/config model/body model/solid model/atoms/bond_order"
  [model/run]="model"
  [hw/arch]="$machine"
  [hw/plan]="$machine hw/arch hw/cost hw/pipeline"
  [hw/rtl]="$machine hw/arch hw/plan hw/cost hw/pipeline"
  [hw/cost]="$machine hw/arch hw/plan hw/pipeline hw/rtl"
  [hw/pipeline]="model/base model/graph"
  [hw/engine]="$machine hw/arch hw/plan"
  [hw/program]="$machine hw/arch hw/plan hw/engine"
  [synth]="$machine hw"
  [emu/lattice]="$machine hw emu/timing"
  [emu/timing]="$machine hw"
  [emu/machine]="$machine hw"
  [emu/systemc]="$machine hw emu/machine"
  [emu/verilated]="$machine hw emu/machine"
  [emu/board]="$machine hw emu/machine"
  [emu/gpu]="model hw"
  [study]="model hw emu/lattice emu/timing"
  [study/bench]="model hw emu/lattice emu/gpu"
  [cli]="model hw emu/lattice"
  [cli/run]="model hw emu/lattice cli/."
  [cli/machine]="model hw synth emu/lattice emu/timing cli/. cli/run"
  [cli/study]="model hw synth emu/lattice emu/timing study cli/. cli/run cli/machine"
  [cli/view]="model hw cli/. cli/run"
  [cli/bench]="model hw study/bench cli/."
  [python]="model hw emu/lattice study cli"
  [library]="model hw emu/lattice cli python"
)

allowed() {  # directory of the includer, included path
  local room=$1
  case "$room" in tests*) return 0 ;; esac
  while [ -z "${may[$room]+set}" ]; do
    case "$room" in */*) room=${room%/*} ;; *) return 1 ;; esac
  done
  for folder in "$room" ${may[$room]}; do
    case "$folder" in
      */.) case "${2#"${folder%.}"}" in */*) ;; *) return 0 ;; esac ;;
      *) case "$2" in "$folder"/*) return 0 ;; esac ;;
    esac
  done
  return 1
}

edges=0 bad=0
while IFS=: read -r file line text; do
  included=${text#*\"} included=${included%%\"*}
  case "$included" in */*) ;; *) continue ;; esac   # generated or local to a tool
  edges=$((edges + 1))
  if ! allowed "${file%/*}" "$included"; then
    echo "$file:$line: ${file%/*} must not include $included"
    bad=1
  fi
done < <(grep -rnE --include='*.h' --include='*.cpp' --include='*.cu' '^#include "' model hw rtl synth emu study cli python library tests 2>/dev/null)
# CLI11's header costs each file that reads it twelve seconds of compiling.
while read -r file; do
  echo "$file: hw/program/options.cpp alone includes CLI11"
  bad=1
done < <(grep -rlE --include='*.h' --include='*.cpp' --include='*.cu' '^#include <CLI/' model hw rtl synth emu study cli python library tests 2>/dev/null |
  grep -vx hw/program/options.cpp)
[ "$edges" -gt 20 ] || { echo "only $edges includes found: the check sees nothing"; exit 1; }
[ "$bad" = 0 ] && echo "$edges includes follow the layering"
exit "$bad"
