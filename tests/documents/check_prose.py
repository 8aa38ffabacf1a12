#!/usr/bin/env python3
"""Refuses constructions that readers had to read twice, in documents, and in the texts and comments of the command line.

usage: check_prose.py [FILE...]     default: every document that a person writes, and the C++ of harness/cli

Prints one line per fault and exits with 1. The self-test runs first: each rule must refuse its own examples and accept its counterexamples.
"""
import re
import sys

from documents import text_of, tracked, written

RATE = r"frame|second|step|substep|iteration|run|side|scene|cell|vertex|triangle|pair|thread|workgroup|group|dispatch|cloth|solver|minute"
# Per rule: what to write instead, the pattern, an example that it refuses, and one that it accepts.
RULES = [
    ("put the subject first, not \"Of\"", r"^Of (?!course)", "Of hulls, a subgroup asks a pair.", "Offsets are equal."),
    ("repeat the noun instead of \"that of\" or \"those of\"", r"\b(?:that|those) of\b", "The bytes are those of the first.", "Use those offsets."),
    ("write \"only\" before the noun instead of \"alone\" after it", r"\balone\b", "pictures alone", "a standalone page"),
    ("write \"one X per Y\"", rf"\b(?:an? \w+|ms|µs|bytes|kB|once|twice|\d+ \w+s) an? (?:{RATE})s?\b", "a thread a vertex", "A thread owns a vertex."),
    ("name the subject instead of a clause with \"What\"", r"^What\b[^?]*[^?]$", "What moves is tested once more.", "What moves?"),
    ("write maximum, minimum, largest or smallest", r"\b(?:greatest|farthest|the least|the most)\b(?! \w+(?:ly|ful|able|ent|on)\b)", "the greatest depth", "at least 4"),
]


def sentences_of_markdown(text):
    """(line, sentence): paragraphs, list items and table cells; without code, headings, links' targets and comments."""
    blank = lambda m: re.sub(r"[^\n]", " ", m[0])
    text = re.sub(r"^[ ]*```.*?^[ ]*```|<!--.*?-->", blank, text, flags=re.M | re.S)
    text = re.sub(r"`[^`\n]*`", "X", text)
    text = re.sub(r"\]\([^)\s]*\)", "]", text)
    start, block = 1, []
    for number, line in enumerate([*text.splitlines(), ""], 1):
        new = not line.strip() or re.match(r"\s*(?:[-*+]|\d+\.)\s|#|\s*\|", line)
        if new and block:
            yield from split_sentences(start, " ".join(block))
            block = []
        if line.strip() and not line.startswith("#"):
            if line.lstrip().startswith("|"):
                for cell in line.strip().strip("|").split(" | "):
                    yield from split_sentences(number, cell)
            else:
                start = start if block else number
                block.append(re.sub(r"^\s*(?:[-*+]|\d+\.)\s+", "", line).strip())


def split_sentences(number, text):
    text = re.sub(r"[*_\[\]]", "", text).strip()
    for sentence in re.split(r"(?<=[.!?:])\s+", text):
        if sentence:
            yield number, sentence


def sentences_of_code(text):
    """(line, sentence): comments, and string literals with neighbouring ones joined as the compiler joins them."""
    for m in re.finditer(r"(?:^[ ]*//[/<]*[^\n]*\n)+|//[/<]*[^\n]*", text, flags=re.M):
        words = re.sub(r"\s*\n\s*//[/<]*\s*|^\s*//[/<]*\s*", " ", m[0])
        yield from split_sentences(text.count("\n", 0, m.start()) + 1, re.sub(r"`[^`]*`", "X", words))
    for m in re.finditer(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*', text):
        words = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', m[0])).replace("\\n", ". ")
        if " " in words:
            yield from split_sentences(text.count("\n", 0, m.start()) + 1, words)


def faults_of(sentence):
    return [rule for rule, form, _, _ in RULES if re.search(form, sentence)]


def self_test():
    for rule, _, wrong, right in RULES:
        assert rule in faults_of(wrong), f"{rule}: accepts {wrong!r}"
        assert not faults_of(right), f"{rule}: refuses {right!r}"
    text = "A thread owns\na vertex. Of two,\none stays.\n\n```sh\n# alone\n```\n| head | Of three |\n"
    assert [n for n, s in sentences_of_markdown(text) if faults_of(s)] == [1, 8], list(sentences_of_markdown(text))


def main():
    self_test()
    names = sys.argv[1:] or written() + tracked("harness/cli/*.[ch]pp")
    count, faults = 0, []
    for name in names:
        sentences = sentences_of_markdown if name.endswith(".md") else sentences_of_code
        for line, sentence in sentences(text_of(name)):
            count += 1
            faults += [f"{name}:{line}: {rule}: {sentence[:160]}" for rule in faults_of(sentence)]
    if not sys.argv[1:] and count < 1000:
        faults.append(f"{count} sentences found; there are more")
    print("\n".join(faults) or f"{len(names)} files, {count} sentences: no fault")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
