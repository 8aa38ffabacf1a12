#!/usr/bin/env bash
# Lines of the product by room and by language: what users get and maintainers read, without tests, results and documents.
#   scripts/count_lines.sh
set -euo pipefail
cd "$(dirname "$0")/.."
product=('*.cpp' '*.hpp' '*.h' '*.in' '*.glsl' '*.comp' '*.vert' '*.frag' '*.js' '*.mjs' '*.css' '*.html' '*.py' '*.sh' '*.cmake' '*CMakeLists.txt')
git ls-files -z -- "${product[@]}" ':!tests' ':!results' | xargs -0 wc -l | awk '
  $2 != "total" {
    split($2, part, "/")
    room = part[1] (part[1] == "harness" || part[1] == "solvers" ? "/" part[2] : "")
    if (room == $2) room = "(top)"
    language = $2; sub(/.*\./, "", language)
    if ($2 ~ /CMakeLists|\.cmake$/) language = "CMake"
    rooms[room] += $1; languages[language] += $1; all += $1
  }
  END {
    for (room in rooms) printf "room      %-24s %6d\n", room, rooms[room]
    for (language in languages) printf "language  %-24s %6d\n", language, languages[language]
    printf "together  %-24s %6d\n", "", all
  }' | sort
