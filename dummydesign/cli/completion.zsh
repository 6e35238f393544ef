#compdef dummydesign
_dummydesign() {
  local -a found open
  found=(${(f)"$(DUMMYDESIGN_COMPLETE="${(pj:\x1f:)words[2,CURRENT]}" dummydesign completion zsh 2>/dev/null)"})
  open=(${(M)found:#*:})
  found=(${found:#*:})
  (( ${#open} )) && compadd -S '' -a open
  (( ${#found} )) && compadd -a found
  (( ${#open} + ${#found} )) || _files
}
compdef _dummydesign dummydesign
