#!/usr/bin/env python3
"""Checks that what documents tell to type exists: commands and options of clothbench, names of scenes and studies, scripts.

usage: check_commands.py CLOTHBENCH

It reads every fenced `sh` block. A command is not run, but it is held against the program's own help and lists. Prints
one line a fault and exits with 1.
"""
import functools
import re
import shlex
import subprocess
import sys

from documents import ROOT, commands_of, text_of, written

PROGRAM = sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__)
# What follows these is another command's business.
END_OF_COMMAND = {"|", "&&", "||", ";", ">", ">>", "2>&1", ")"}
# Placeholders that documents use for a user's own things.
PLACEHOLDER = re.compile(r"^[A-Z]+$|^my-|[<>…*$]|^results/|^build/|^after|^before")


def clothbench(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=ROOT, check=False)


@functools.cache
def options_of(command):
    done = clothbench(*command.split(), "--help")
    return set(re.findall(r"(?<![\w-])(--?[\w][\w-]*)", done.stdout)) if done.returncode == 0 else None


@functools.cache
def names(what):
    return set(re.findall(r"[\w./-]+", clothbench("list", what).stdout))


def words_of(command):
    try:
        return shlex.split(command.text)
    except ValueError:
        return []  # words of another program


def known_name(command, word, text):
    if PLACEHOLDER.search(word) or (ROOT / word).exists():
        return True
    if f"{word}.json" in text:  # made by a command before
        return True
    if command == "study":
        return word in names("studies")
    return word in names("scenarios") or (ROOT / "scenarios" / f"{word}.json").exists()


def faults_of(words, text):
    for k, word in enumerate(words):
        if word.split("/")[-1] == "clothbench" and (k == 0 or words[k - 1] in END_OF_COMMAND or words[k - 1].startswith("<(")):
            end = next((j for j in range(k, len(words)) if words[j] in END_OF_COMMAND), len(words))
            yield from faults_of_call(words[k + 1:end], text)
        if re.match(r"^scripts/[\w/.-]+$", word) and not (ROOT / word).exists():
            yield f"{word}: no such script"


def faults_of_call(words, text):
    command = next((w for w in words if not w.startswith("-")), None)
    if command is None or PLACEHOLDER.search(command):
        return
    options = options_of(command)
    if options is None:
        yield f"{command}: no such command"
        return
    for word in words:
        option = word.split("=")[0]
        if option.startswith("--") and option not in options | options_of("") and not option.startswith("--benchmark_"):
            yield f"{command}: no option {option}"
    first = next((w for w in words[words.index(command) + 1:] if not w.startswith("-")), None)
    position = words.index(command) + 1
    if command in ("run", "plan", "study", "xr") and first is not None and words[position] == first and not known_name(command, first, text):
        yield f"{command}: {first}: no such name"


def main():
    faults, count = [], 0
    for name in written():
        text = text_of(name)
        for command in commands_of(name, text):
            count += 1
            faults += [f"{name}:{command.line}: {command.key[:80]}: {fault}" for fault in faults_of(words_of(command), text)]
    if count < 100:
        faults.append(f"{count} commands found; there are more")
    print("\n".join(faults) if faults else f"{count} commands: what they name exists")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
