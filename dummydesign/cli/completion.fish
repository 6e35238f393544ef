function __dummydesign
  set -l now (commandline -ct)
  set -l typed (commandline -opc) "$now"
  set -lx DUMMYDESIGN_COMPLETE (string join \x1f -- $typed[2..])
  set -l found (dummydesign completion fish 2>/dev/null)
  if set -q found[1]
    printf '%s\n' $found
  else
    __fish_complete_path "$now"
  end
end
complete -c dummydesign -f -a '(__dummydesign)'
