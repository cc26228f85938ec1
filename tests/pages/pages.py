"""What the pages tell a reader to type: every command of README.md and docs/*.md."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
LOG = "decisions.md"  # tells what was done, not what to do
FENCE = re.compile(r"^```(\w*)([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SPAN = re.compile(r"(?<!`)`([^`\n]+(?:\n[^`\n]+)?)`(?!`)")
INDENTED = re.compile(r"\n\n((?:    \S[^\n]*\n(?:    [^\n]*\n)*)+)")
NEED_A_CLUSTER = ("kubectl", "sbatch", "sinfo", "squeue")  # known, and run by nobody here
PROGRAMS = ("make", "snakemake", "plasmapyro", "python", "pytest", "pip", "git", "cp", ".", *NEED_A_CLUSTER)
LANGUAGES = {"sh", "python", "yaml", "text"}


@dataclass(frozen=True)
class Command:
    page: str
    line: str

    @property
    def words(self):
        """Words without the settings of the environment before them."""
        words = shlex.split(self.line)
        while re.match(r"[A-Z_]+=", words[0]):
            words = words[1:]
        return words

    @property
    def variables(self):
        return re.findall(r"([A-Z_]+)=", self.line.partition(self.words[0])[0])


def fences(page):
    """(language, rest of the first line, content) of each box; a box without language is one of commands.

    Directives of the site, such as {toctree}, are left out.
    """
    found = FENCE.findall(page.read_text(encoding="utf-8"))
    return [
        (language or "sh", rest.strip(), content)
        for language, rest, content in found
        if not rest.startswith("{")
    ]


def typed(content):
    """Lines of a box of commands, continued ones joined, without comments."""
    for line in content.replace("\\\n", " ").splitlines():
        line = re.sub(r"(^|\s)#\s.*$", "", line).strip()
        if line:
            yield " ".join(line.split())


def is_command(line):
    words = line.split()
    while words and re.match(r"[A-Z_]+=", words[0]):
        words = words[1:]
    return len(words) > 1 and words[0] in PROGRAMS and not words[1].startswith(("=", "("))


def commands(page):
    """Every command of a page: in boxes, in indented blocks and in the running text."""
    text = page.read_text(encoding="utf-8")
    lines = [line for language, _, content in fences(page) if language == "sh" for line in typed(content)]
    prose = FENCE.sub("", text)
    for block in INDENTED.findall(prose):
        lines += [line for line in typed(block) if is_command(line)]
    lines += [" ".join(span.split()) for span in SPAN.findall(prose) if is_command(" ".join(span.split()))]
    return [Command(page.name, line) for line in dict.fromkeys(lines)]


def all_commands(program):
    """The commands of all pages that call a program."""
    pages = [page for page in PAGES if page.name != LOG]
    return [command for page in pages for command in commands(page) if command.words[0] == program]
