#!/usr/bin/env python3
"""Checks that phrases of retired.txt do not come back in code, documents, help texts and the page.

Prints one line a fault and exits with 1.
"""
import re
import sys
from pathlib import Path

from documents import ROOT, tracked

LIST = Path(__file__).with_name("retired.txt")
TEXT = (".c", ".cmake", ".comp", ".cpp", ".css", ".def", ".frag", ".glsl", ".h", ".hpp", ".html", ".in", ".js", ".json", ".md", ".mjs", ".py", ".sh",
        ".txt", ".vert", ".yml")
# Between two words of a phrase: blanks, or a line break with the marks of a comment or of a string that goes on.
BETWEEN = r'(?:[ \t]+|[ \t]*"?[ \t]*\n[ \t]*(?:///?<?|#|\*|")?[ \t]*)'


def entries():
    """Phrases with what to write instead, and paths that are left out."""
    phrases, aside = {}, []
    for line in LIST.read_text(encoding="utf-8").splitlines():
        if line.startswith("! "):
            path, reason = line[2:].split(": ", 1)
            assert reason and (ROOT / path).exists(), f"{LIST.name}: {line}"
            aside.append(path)
        elif line and not line.startswith("#"):
            phrase, instead = line.split(" -> ", 1)
            assert phrase.lower() not in phrases, f"{LIST.name}: {phrase}: twice"
            phrases[phrase.lower()] = instead
    return phrases, aside


def pattern_of(phrases):
    # The longest first, so that a phrase is named rather than a word of it.
    one = "|".join(BETWEEN.join(map(re.escape, phrase.split())) for phrase in sorted(phrases, key=len, reverse=True))
    return re.compile(rf"(?<![\w-])(?:{one})(?![\w-])", flags=re.I)


def main():
    phrases, aside = entries()
    pattern = pattern_of(phrases)
    faults, count = [], 0
    for name in tracked():
        path = ROOT / name
        if not name.endswith(TEXT) or any(name == a or (a.endswith("/") and name.startswith(a)) for a in aside):
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        count += 1
        for found in pattern.finditer(text):
            phrase = " ".join(re.findall(r"[\w'-]+", found[0])).lower()
            faults.append(f"{name}:{text.count(chr(10), 0, found.start()) + 1}: \"{phrase}\" is retired; instead: {phrases[phrase]}")
    if count < 500:
        faults.append(f"{count} files found; there are more")
    print("\n".join(faults) if faults else f"{count} files: none of {len(phrases)} retired phrases")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
