_dummydesign() {
  local IFS=$'\x1f'
  local typed="${COMP_WORDS[*]:1:COMP_CWORD}"
  IFS=$'\n'
  COMPREPLY=($(DUMMYDESIGN_COMPLETE="$typed" dummydesign completion bash 2>/dev/null))
  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *: ]] && compopt -o nospace 2>/dev/null
  return 0
}
complete -o default -F _dummydesign dummydesign
