_clothbench() {
  local IFS=$'\n' line=${COMP_LINE:0:COMP_POINT} words
  IFS=' ' read -ra words <<<"$line"
  [[ $line == *' ' ]] && words+=('')
  COMPREPLY=($("${words[0]}" completion words -- "${words[@]:1}" 2>/dev/null))
  [[ ${COMPREPLY[0]} == *[=/] ]] && compopt -o nospace
  # Bash puts the answer in place of what stands after its own last break.
  local cut=${words[${#words[@]}-1]%"${COMP_WORDS[COMP_CWORD]}"}
  COMPREPLY=("${COMPREPLY[@]#"$cut"}")
}
complete -o default -F _clothbench clothbench
