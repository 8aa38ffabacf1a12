"""Shared by the checks of documents: the list of documents, and the shell commands in them."""
import dataclasses
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Files that the program writes, or that grow with every release.
GENERATED = re.compile(r"^(CHANGELOG\.md|harness/metrics/REGISTRY\.md|results/reference/.*(?<!README)\.md)$")
# A fenced block, with the mark before it, if any, such as <!-- needs hardware: a headset -->.
BLOCK = re.compile(r"^(?:[ ]*<!-- needs (hardware|network|root): (.+?) -->\n)?([ ]*)```(?:sh|bash)\n(.*?)^\3```", flags=re.M | re.S)


def tracked(*patterns):
    """Names of the tree's files, relative to its root."""
    out = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--", *patterns], capture_output=True, text=True, check=True).stdout
    return [name for name in out.split("\0") if name and (ROOT / name).is_file()]


def documents():
    return tracked("*.md")


def written():
    """Documents that a person writes."""
    return [name for name in documents() if not GENERATED.match(name)]


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


@dataclasses.dataclass
class Command:
    document: str
    line: int
    text: str  # without its comment
    mark: str  # "hardware", "network" or "root" if it cannot be run here, otherwise empty

    @property
    def key(self):
        """The command on one line, as tables name it."""
        return " ".join(self.text.split())


def without_comment(text):
    """The text before a shell comment, and whether a quotation is still open at its end."""
    quote = ""
    for k, c in enumerate(text):
        if quote:
            quote = "" if c == quote else quote
        elif c in "'\"":
            quote = c
        elif c == "#" and (k == 0 or text[k - 1].isspace()):
            return text[:k].rstrip(), False
    return text.rstrip(), bool(quote)


def commands_of(name, text):
    """The commands of the fenced sh blocks, in order. A command may span several lines."""
    for block in BLOCK.finditer(text):
        pending = ""
        first = line = text.count("\n", 0, block.start(4)) + 1
        for row in block[4].splitlines():
            first = first if pending else line
            line += 1
            pending += row.strip()
            command, open_quote = without_comment(pending)
            if open_quote:
                pending += "\n"
            elif command.endswith("\\"):
                pending = command[:-1]
            else:
                if command:
                    yield Command(name, first, command, block[1] or "")
                pending = ""


def all_commands():
    for name in written():
        yield from commands_of(name, text_of(name))


if __name__ == "__main__":
    print("\n".join(written()))
