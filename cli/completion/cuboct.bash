# SPDX-License-Identifier: MIT
# Completion of cuboct for bash. What may come next is asked of the program itself: `cuboct COMMAND --help-as words`
# (cli/help_forms.h), so that it is that of the cuboct which is typed.

# A line's four fields into names, kind, values, text; `read` would skip the empty ones.
_cuboct_fields() {
  names=${1%%$'\t'*} text=${1#*$'\t'}
  kind=${text%%$'\t'*} text=${text#*$'\t'}
  values=${text%%$'\t'*} text=${text#*$'\t'}
}

# The values of one kind that begin with $cur.
_cuboct_values() {  # KIND VALUES
  local done=
  case "$1" in
    *,...) [[ $cur != *,* ]] || done=${cur%,*}, ;;  # those before the last comma stand
  esac
  if [ -n "$2" ]; then
    mapfile -t COMPREPLY < <(compgen -P "$done" -W "${2//,/ }" -- "${cur#"$done"}")
    return
  fi
  case "${1%,...}" in
    SCENE | STUDY | ARCH)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -X '!*.toml' -- "$cur"; compgen -d -- "$cur") ;;
    FILE)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    DIR)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
  esac
}

_cuboct() {
  local cur=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]} program=${COMP_WORDS[0]/#\~/$HOME}
  local command=${COMP_WORDS[1]} line names kind values text
  local -a lines words=()
  COMPREPLY=()
  # bash cuts "--engine=lattice" at the equals sign.
  if [ "$cur" = = ]; then cur=''; elif [ "$option" = = ]; then option=${COMP_WORDS[COMP_CWORD - 2]}; fi

  if [ "$COMP_CWORD" = 1 ] || [ "$command" = help ]; then
    mapfile -t lines < <("$program" --help-as words 2>/dev/null)
    for line in "${lines[@]}"; do
      _cuboct_fields "$line"
      [ "$command" = help ] && [[ $names == -* ]] || words+=("${names//,/ }")
    done
    [ "$COMP_CWORD" != 1 ] || words+=(help)
    mapfile -t COMPREPLY < <(compgen -W "${words[*]}" -- "$cur")
    return
  fi

  mapfile -t lines < <("$program" "$command" --help-as words 2>/dev/null)
  for line in "${lines[@]}"; do
    _cuboct_fields "$line"
    if [ -n "$kind" ] && [[ $option == -* && ,$names, == *,"$option",* ]]; then
      _cuboct_values "$kind" "$values"
      return
    fi
    words+=("${names//,/ }")
  done
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${words[*]}" -- "$cur")
    return
  fi
  for line in "${lines[@]}"; do
    _cuboct_fields "$line"
    [ -n "$names" ] || { _cuboct_values "$kind" "$values"; return; }
  done
}

complete -F _cuboct cuboct
