function __clothbench_words
  set -l words (commandline -opc)
  clothbench completion words -- $words[2..-1] (commandline -ct) 2>/dev/null
end
complete -c clothbench -a '(__clothbench_words)'
