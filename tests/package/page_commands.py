"""Runs the commands of a page as its reader would, in a fresh folder, and compares what they print with what the page says.

The commands are the blocks marked `sh`. A block marked `text` after one is what it prints, on both streams together; a line
`...` in it stands for any lines. A block ends with exit code 0, unless its last line says `# exit code N`. Blocks of
other kinds are not run.

Examples: python3 page_commands.py --programs build/release/sim/cli --page README.md --section "Your own axis in ten minutes"
          python3 page_commands.py --programs build/release/sim/cli --page firmware/FAULTS.md --renew
"""

import argparse
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$\n?", re.MULTILINE | re.DOTALL)
EXIT_CODE = re.compile(r"# exit code (\d+)$")
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")
LEFT_OUT = "..."


@dataclasses.dataclass
class Step:
    commands: str
    printed: str | None  # what the page says; None where it says nothing
    span: tuple  # of `printed` in the page

    @property
    def exit_code(self):
        named = EXIT_CODE.search(self.commands.rstrip("\n"))
        return int(named[1]) if named else 0


def section_span(text, heading):
    """From a heading to the next one of any level; headings within blocks are comments of a shell."""
    if not heading:
        return 0, len(text)
    blocks = [block.span() for block in FENCE.finditer(text)]
    headings = [found for found in re.finditer(r"^#+ (.*)$", text, re.MULTILINE)
                if not any(begin <= found.start() < end for begin, end in blocks)]
    begins = [place for place, found in enumerate(headings) if found[1] == heading]
    if len(begins) != 1:
        sys.exit(f"the page has {len(begins)} headings \"{heading}\"")
    after = headings[begins[0] + 1:begins[0] + 2]
    return headings[begins[0]].end(), after[0].start() if after else len(text)


def steps_of(text, span):
    steps = []
    for block in FENCE.finditer(text, *span):
        if block[1] == "sh":
            steps.append(Step(block[2], None, ()))
        elif block[1] == "text" and steps and steps[-1].printed is None:
            steps[-1] = Step(steps[-1].commands, block[2], block.span(2))
    return steps


def head_and_tail(printed):
    """What comes before the line that stands for others, and what comes after it; None where there is no such line."""
    lines = printed.splitlines()
    if LEFT_OUT not in lines:
        return None
    place = lines.index(LEFT_OUT)
    return lines[:place], lines[place + 1:]


def without_figures(text):
    """Every number but 0 becomes #, and how columns are filled up no longer counts."""
    return re.sub(r" +", " ", NUMBER.sub(lambda number: "0" if number[0] == "0" else "#", text))


def agrees(said, printed):
    parts = head_and_tail(said)
    if parts is None:
        return said == printed
    head, tail = parts
    lines = printed.splitlines()
    return len(lines) > len(head) + len(tail) and lines[:len(head)] == head and lines[len(lines) - len(tail):] == tail


def renewed(said, printed):
    parts = head_and_tail(said)
    if parts is None:
        return printed
    head, tail = parts
    lines = printed.splitlines()
    return "\n".join(lines[:len(head)] + [LEFT_OUT] + lines[len(lines) - len(tail):]) + "\n"


def run(step, folder, programs):
    environment = dict(os.environ, PATH=os.pathsep.join([*programs, os.environ["PATH"]]), LC_ALL="C.UTF-8")
    ended = subprocess.run(["bash", "-c", step.commands], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", timeout=600, check=False)
    return ended.returncode, ended.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=pathlib.Path, action="append", required=True, help="a folder of commands")
    parser.add_argument("--page", type=pathlib.Path, required=True)
    parser.add_argument("--section", default="", help="the heading of the part to run; all of the page without it")
    parser.add_argument("--most", type=int, default=0, help="fail if there are more commands than this")
    parser.add_argument("--words", action="store_true", help="compare words and zeros only: for runs in real time")
    parser.add_argument("--renew", action="store_true", help="write what is printed into the page")
    options = parser.parse_args()
    text = options.page.read_text(encoding="utf-8")
    steps = steps_of(text, section_span(text, options.section))
    if not steps:
        sys.exit(f"{options.page} has no block marked sh to run")
    if 0 < options.most < len(steps):
        sys.exit(f"{options.page} needs {len(steps)} commands, more than {options.most}")
    wrong, replaced = 0, []
    shown = without_figures if options.words else str
    with tempfile.TemporaryDirectory() as folder:
        for step in steps:
            code, printed = run(step, folder, [str(program.resolve()) for program in options.programs])
            if code != step.exit_code:
                wrong += 1
                print(f"{step.commands}ended with exit code {code} instead of {step.exit_code}:\n{printed}")
            elif step.printed is not None and not agrees(shown(step.printed), shown(printed)):
                wrong += 1
                replaced.append((step.span, renewed(step.printed, printed)))
                print(f"{step.commands}prints\n{printed}and the page says\n{step.printed}")
    if options.renew:
        for (begin, end), printed in reversed(replaced):
            text = text[:begin] + printed + text[end:]
        options.page.write_text(text, encoding="utf-8")
    print(f"{options.page}: {len(steps)} blocks run, {wrong} not as the page says")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
