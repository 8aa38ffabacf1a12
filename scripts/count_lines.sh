#!/usr/bin/env bash
# Lines of the product by room and by language, and lines of the tests. Results and documents do not count.
#   scripts/count_lines.sh
set -euo pipefail
cd "$(dirname "$0")/.."
code=('*.cpp' '*.hpp' '*.h' '*.in' '*.glsl' '*.comp' '*.vert' '*.frag' '*.js' '*.mjs' '*.css' '*.html' '*.py' '*.sh' '*.cmake' '*CMakeLists.txt')
git ls-files -z -- "${code[@]}" ':!results' | while IFS= read -r -d "" file; do
  [ ! -f "$file" ] || printf "%s\0" "$file"  # deleted, not committed yet
done | xargs -0 wc -l | awk '
  $2 != "total" {
    split($2, part, "/")
    if (part[1] == "tests") { tests += $1; next }
    room = part[1] (part[1] == "harness" || part[1] == "solvers" ? "/" part[2] : "")
    if (room == $2) room = "(top)"
    language = $2; sub(/.*\./, "", language)
    if ($2 ~ /CMakeLists|\.cmake$/) language = "CMake"
    rooms[room] += $1; languages[language] += $1; product += $1
  }
  END {
    for (room in rooms) printf "room      %-24s %6d\n", room, rooms[room]
    for (language in languages) printf "language  %-24s %6d\n", language, languages[language]
    printf "together  %-24s %6d\n", "product", product
    printf "together  %-24s %6d\n", "tests", tests
  }' | sort
