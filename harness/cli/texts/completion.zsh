#compdef clothbench
_clothbench() {
  local -a found
  found=("${(@f)$("${words[1]}" completion words -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  [[ -n "$found[1]" ]] && compadd -Q -- "${found[@]}" || _files
}
# A file of $fpath is itself the function when it is first asked.
if [[ $funcstack[1] == _clothbench ]]; then _clothbench "$@"; else compdef _clothbench clothbench; fi
