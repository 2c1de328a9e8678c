#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What TAB offers in bash, and in zsh where that is installed.
# usage: completion.sh ROOT CUBOCT
set -euo pipefail
export LC_ALL=C
root=$1 cuboct=$2
cd "$root"
tried=0

of_bash() {  # WORD...: what is offered for the last one
  bash -u -c '
    . cli/completion/cuboct.bash
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _cuboct
    printf "%s\n" "${COMPREPLY[@]}"' complete "$@" | sort
}

# The same of zsh: its own builtins say what they were asked to offer.
of_zsh() {
  zsh -f -c '
    _describe() {
      local list=${@[-1]} entry
      for entry in "${(@P)list}"; do [[ $entry != ${PREFIX}* ]] || print -r -- ${entry%%:*}; done
    }
    compadd() { local entry; for entry in "${(@P)@[-1]}"; do [[ $entry != ${PREFIX}* ]] || print -r -- $done$entry; done }
    compset() { local cut=${PREFIX%${PREFIX##${~2}}}; done+=$cut PREFIX=${PREFIX#$cut} }
    _files() { print -r -- files "$@" }
    words=("$@") CURRENT=$# PREFIX=${@[-1]} done=""
    . cli/completion/_cuboct' complete "$@" | sort
}

offers() {  # EXPECTED WORD...: lines in the order of sort
  local expected=$1 got shell
  shift
  for shell in "${shells[@]}"; do
    got=$("of_$shell" "$cuboct" "$@")
    tried=$((tried + 1))
    [ "$got" = "$expected" ] || { printf '%s: %s\nexpected:\n%s\ngot:\n%s\n' "$shell" "$*" "$expected" "$got"; exit 1; }
  done
}

shells=(bash)
if command -v zsh >/dev/null; then shells+=(zsh); fi
commands=$("$cuboct" --help-as words | cut -f1 | tr , '\n' | grep -v '^-')
offers "$(printf '%s\n' $commands help -h --help --version | sort)" ''
offers "$(printf '%s\n' $commands | sort)" help ''
for command in $commands; do  # in whichever program it is
  "$cuboct" "$command" --help >/dev/null 2>&1 || continue  # left out of this build
  offers --help "$command" --hel
done
offers $'lattice' run --engine l
offers $'golden\ngpu' run scenes/coupon.toml --engine g
offers 'compiled' run --rule-code comp
offers $'--stall-rate\n--stall-seed' crosscheck --stall
offers $'speed\nstrain' picture out --field s
offers '' run --steps ''
offers '' nonsense --
shells=(bash)
offers 'golden,lattice' crosscheck --engines golden,la
offers $'scenes/accuracy\nscenes/acetal.toml\nscenes/archs' run scenes/a
offers 'scenes/studies/acetal.csv' curves --out scenes/studies/acetal.c
offers 'scenes/archs' run --out scenes/ar
offers 'lattice' run --engine = l
if command -v zsh >/dev/null; then
  shells=(zsh)
  offers 'golden,lattice' crosscheck --engines golden,la
  offers 'files -g *.toml' run scenes/a
  offers 'files -/' run --out x
  offers '--engine=lattice' run --engine=l
fi
[ "$tried" -ge 20 ] || { echo "only $tried tried"; exit 1; }
echo "$tried completions"
