"""Proves of a linked bare-metal image what a controller needs: no heap, no double arithmetic, a bounded stack, a size.

Usage: check_image.py IMAGE.elf --code BYTES --ram BYTES

Beside the image lies its map (IMAGE.elf.map), and beside every object the call graph that the compiler wrote
(-fcallgraph-info=su). The stack of library functions is read from their code. The bound is that of the longest chain of
calls from reset, plus that of the longest interrupt handler, if there is one, and of what the processor saves for it: all
interrupts have one priority, so one is served at a time. Exit codes: 0 proved; 1 not so; 2 bad command line.
"""
import argparse
import glob
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field

HEAP = re.compile(r"^(_sbrk|_?(malloc|calloc|realloc|free)(_r)?|_Znw\w*|_Zna\w*|_ZdlPv\w*|_ZdaPv\w*)$")
DOUBLE = re.compile(r"^__(aeabi_(c?d\w*|[a-z]+2d)|\w*df[23sd]i?\w*)$")
DOUBLE_INSTRUCTION = re.compile(r"^v(?!mov|ldr|str)\w+\.(\w+\.)?f64")
EXCEPTIONS = re.compile(r"^(__cxa_(throw|allocate_exception)|_Unwind_\w+)$")
ROOT = "reset_handler"
SAVED_BY_PROCESSOR = 108  # 8 words, 18 of the FPU, one to align (Armv7-M, B1.5.7)


@dataclass
class Function:
    stack: int
    calls: set = field(default_factory=set)
    indirect: bool = False  # calls by pointer
    double: bool = False  # computes in double precision on the FPU
    dynamic: bool = False  # its frame has no bound


def run(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def call_graph_files(elf):
    """Of the objects that the map says were linked."""
    build = os.path.dirname(os.path.abspath(elf))
    while not os.path.exists(os.path.join(build, "build.ninja")):
        if build == os.path.dirname(build):
            sys.exit(f"{elf}: lies in no build tree of Ninja")
        build = os.path.dirname(build)
    files = []
    with open(elf + ".map", encoding="utf-8") as file:
        for path in re.findall(r"^LOAD (\S+)$", file.read(), re.MULTILINE):
            path = os.path.join(build, path)
            if path.endswith(".obj"):
                files.append(path.removesuffix(".obj") + ".ci")
            elif path.startswith(build):
                name = os.path.basename(path).removeprefix("lib").removesuffix(".a")
                files += glob.glob(f"{os.path.dirname(path)}/CMakeFiles/{name}.dir/**/*.ci", recursive=True)
    return files


def compiled_functions(files):
    functions = {}
    for name in files:
        with open(name, encoding="utf-8") as file:
            text = file.read()
        for title, label in re.findall(r'node: \{ title: "([^"]+)" label: "([^"]*)"', text):
            figure = re.search(r"(\d+) bytes \(([^)]*)\)", label)
            if not figure:
                continue
            function = functions.setdefault(title.split(":")[-1], Function(0))
            function.stack = max(function.stack, int(figure[1]))
            function.dynamic |= figure[2] not in ("static", "dynamic,bounded")
        for source, target in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text):
            function = functions.setdefault(source.split(":")[-1], Function(0))
            if target == "__indirect_call":
                function.indirect = True
            else:
                function.calls.add(target.split(":")[-1])
    return functions


def registers_in(text):
    """Bytes of a register list."""
    total = 0
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        count = int(last[1:]) - int(first[1:]) + 1 if last else 1
        total += count * (8 if first.startswith("d") else 4)
    return total


def library_functions(elf):
    """Every function of the image by its code: all that it ever takes off the stack pointer, and whom it calls."""
    functions, name = {}, None
    for line in run("arm-none-eabi-objdump", "-d", "--no-show-raw-insn", elf).splitlines():
        if header := re.match(r"^[0-9a-f]+ <(\S+)>:$", line):
            name = header[1]
            functions[name] = Function(0)
            continue
        instruction = re.match(r"^\s*[0-9a-f]+:\s+(\S+)\s*(.*)$", line)
        if not instruction or name is None:
            continue
        operation, operands = instruction[1], instruction[2]
        function = functions[name]
        function.double |= bool(DOUBLE_INSTRUCTION.match(operation))
        if pushed := re.match(r"^(?:sp!, )?\{(.*)\}", operands):
            if operation.startswith(("push", "vpush", "stmdb", "stmfd", "vstmdb")):
                function.stack += registers_in(pushed[1])
        elif operation.startswith("sub") and (size := re.match(r"^sp, (?:sp, )?#(\d+)", operands)):
            function.stack += int(size[1])
        elif operation.startswith("str") and (size := re.search(r"\[sp, #-(\d+)\]!", operands)):
            function.stack += int(size[1])
        elif operation.startswith("sub") and operands.startswith("sp,"):
            function.dynamic = True
        elif operation.startswith("b") and (target := re.search(r"<([^>+]+)>$", operands)):
            if target[1] != name:
                function.calls.add(target[1])
        elif operation.startswith("blx") or (operation.startswith("bx") and "lr" not in operands):
            function.indirect = True
    return functions


class StackBound:
    """Worst chains of calls. `problems` names what keeps the figure from being a bound."""

    def __init__(self, elf, symbols, linked):
        self.compiled = compiled_functions(call_graph_files(elf))
        self.linked = linked
        # Start-up calls constructors by pointer; with none to call it calls nobody.
        no_constructors = symbols["image_constructors_begin"] == symbols["image_constructors_end"]
        self.harmless = {"_ZN9breakaway10bare_metal14prepare_memoryEv", ROOT} if no_constructors else set()
        self.problems = set()
        self.known = {}

    def worst(self, name, above=()):
        if name in self.known:
            return self.known[name]
        if name in above:
            self.problems.add(f"recursion through {name}")
            return 0, [name]
        function = self.compiled.get(name) or self.linked.get(name)
        if function is None:
            self.problems.add(f"{name} is not in the image, but called")
            return 0, [name]
        if function.dynamic:
            self.problems.add(f"the frame of {name} has no bound")
        if function.indirect and name not in self.harmless:
            self.problems.add(f"{name} calls by pointer")
        deepest, chain = 0, []
        for callee in function.calls:
            depth, path = self.worst(callee, (*above, name))
            if depth > deepest or not chain:
                deepest, chain = depth, path
        self.known[name] = function.stack + deepest, [name, *chain]
        return self.known[name]


def read_symbols(elf):
    return {name: int(address, 16) for address, name in
            re.findall(r"^([0-9a-f]+) \S (\S+)$", run("arm-none-eabi-nm", elf), re.MULTILINE)}


def memory_use(elf):
    """Bytes of code, constants and initial values, and of RAM, the reserved stack included; sections that are written and
    executed."""
    code = ram = 0
    unsafe = []
    for name, size, flags in re.findall(r"^ *\[ *\d+\] (\.\S+) +\w+ +\w+ \w+ (\w+) \w+ +(\w*A\w*)",
                                        run("arm-none-eabi-readelf", "-SW", elf), re.MULTILINE):
        written = "W" in flags
        if written:
            ram += int(size, 16)
        if not written or name == ".data":
            code += int(size, 16)
        if written and "X" in flags and int(size, 16) > 0:
            unsafe.append(name)
    return code, ram, unsafe


def examine(elf):
    """What is known of an image: code, ram, stack, stack_reserved, chains, problems."""
    symbols = read_symbols(elf)
    problems = [f"{what}: {name} is linked" for what, pattern in
                (("heap", HEAP), ("double arithmetic", DOUBLE), ("exceptions", EXCEPTIONS))
                for name in symbols if pattern.match(name)]
    linked = library_functions(elf)
    problems += [f"double arithmetic: {name} computes in it" for name, function in linked.items() if function.double]
    bound = StackBound(elf, symbols, linked)
    chains = [bound.worst(ROOT)]
    stack = chains[0][0]
    if handlers := [name for name in symbols if name.endswith("_handler") and name != ROOT]:
        chains.append(max(bound.worst(name) for name in handlers))
        stack += SAVED_BY_PROCESSOR + chains[1][0]
    reserved = symbols["image_stack_top"] - symbols["image_stack_bottom"]
    problems += sorted(bound.problems)
    if stack > reserved:
        problems.append(f"the stack may need {stack} bytes; {reserved} are reserved")
    code, ram, unsafe = memory_use(elf)
    problems += [f"{name} is written and executed" for name in unsafe]
    return {"code": code, "ram": ram, "stack": stack, "stack_reserved": reserved, "chains": chains, "problems": problems}


def demangled(chain):
    names = run("arm-none-eabi-c++filt", "-p", *chain).split("\n")
    return " > ".join(name.replace("breakaway::", "") for name in names if name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image")
    parser.add_argument("--code", type=int, required=True, help="most bytes of code, constants and initial values")
    parser.add_argument("--ram", type=int, required=True, help="most bytes of RAM, with the stack")
    arguments = parser.parse_args()
    facts = examine(arguments.image)
    problems = facts["problems"]
    for memory, most in (("code", arguments.code), ("ram", arguments.ram)):
        if facts[memory] > most:
            problems.append(f"{memory}: {facts[memory]} bytes are more than {most}")
    print(f"{os.path.basename(arguments.image)}: code {facts['code']} of {arguments.code} bytes, "
          f"RAM {facts['ram']} of {arguments.ram}, stack at most {facts['stack']} of {facts['stack_reserved']}")
    for size, chain in facts["chains"]:
        print(f"  {size} bytes: {demangled(chain)}")
    for problem in problems:
        print(f"  NOT PROVED: {problem}")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
