"""Finds where a source can be mutated, from clang's own tree of it.

A point is a set of edits that keep the source on its lines and put switches (switches.hpp) around an expression or a
statement. What only a compiler evaluates (template arguments, case labels, constexpr variables, static assertions) is
no point; a constexpr variable is mutated where it is used.
"""

import dataclasses
import json
import re
import subprocess

RELATIONS = {"<": ("less", "<="), "<=": ("less_equal", "<"), ">": ("greater", ">="), ">=": ("greater_equal", ">")}
ARITHMETIC = {"+": ("add", "-"), "-": ("subtract", "+"), "*": ("multiply", "/"), "/": ("divide", "*"),
              "%": ("modulo", "*"), "&": ("bit_and", "|"), "|": ("bit_or", "&"), "^": ("bit_xor", "|"),
              "<<": ("shift_left", ">>"), ">>": ("shift_right", "<<")}
ASSIGNMENTS = {"+=": ("add_to", "-="), "-=": ("subtract_from", "+="), "*=": ("multiply_by", "/="),
               "/=": ("divide_by", "*="), "&=": ("and_with", "|="), "|=": ("or_with", "&="), "^=": ("xor_with", "|="),
               "<<=": ("shift_left_by", ">>="), ">>=": ("shift_right_by", "<<=")}
UNARY = {"-": "minus", "~": "complement"}
STEPS = {"++": "increment", "--": "decrement"}
# Never evaluated at run time, or written down nowhere.
SKIPPED = {"ConstantExpr", "TemplateArgument", "StaticAssertDecl", "EnumDecl", "RequiresExpr", "ConceptDecl",
           "ConceptSpecializationExpr", "UnaryExprOrTypeTraitExpr", "CXXDefaultArgExpr", "CXXDefaultInitExpr",
           "CXXNoexceptExpr", "TypeTraitExpr", "UserDefinedLiteral", "ClassTemplateSpecializationDecl",
           "SizeOfPackExpr", "CXXDeductionGuideDecl", "TypeAliasDecl", "TypedefDecl", "UsingDecl"}
STATEMENT_PARENTS = {"CompoundStmt", "IfStmt", "ForStmt", "WhileStmt", "DoStmt", "CXXForRangeStmt", "CaseStmt",
                     "DefaultStmt"}
FUNCTIONS = {"FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "CXXConversionDecl", "CXXDestructorDecl"}
NOT_DELETED = {"ParenExpr", "DeclRefExpr", "MemberExpr", "IntegerLiteral", "CStyleCastExpr", "LambdaExpr"}
NUMBER_TYPE = re.compile(r"^(const )?(unsigned|int|long|short|char|bool|float|double|Scalar|"
                         r"(std::)?u?int\d+_t|(std::)?size_t|"
                         r"(\w+::)*Duration|std::chrono::\w+|unsigned (int|char|short|long))$")


@dataclasses.dataclass
class Mutant:
    path: str
    line: int
    code: str      # the line's text
    change: str    # what is different, in the source's own words
    id: int

    @property
    def key(self):
        return f"{self.path}|{self.code}|{self.change}"


@dataclasses.dataclass
class Point:
    begin: int
    end: int
    depth: int
    edits: list    # (begin, end, text, is it put after what it stands behind): text replaces; {0} and {1} are numbers
    changes: list  # of one or two mutants


class Tree:
    """clang's tree with the file and the place of every node."""

    def __init__(self, compile_flags, source):
        command = ["clang++", "-std=c++20", *compile_flags, "-fsyntax-only", "-w", "-Xclang", "-ast-dump=json",
                   "-Xclang", "-ast-dump-filter=breakaway", source]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            raise SystemExit(f"clang cannot read {source}:\n{done.stderr[:2000]}")
        self.documents = []
        text, at, decoder = done.stdout, done.stdout.find("{"), json.JSONDecoder()
        while at >= 0:
            document, at = decoder.raw_decode(text, at)
            self.documents.append(document)
            at = text.find("{", at)
        self.constants = set()
        for document in self.documents:
            self.file = None
            self.place(document)

    def location(self, where):
        """(file, offset, end of the token), or None where a macro made it; files are written when they change."""
        if "spellingLoc" in where or "expansionLoc" in where:
            for name in ("spellingLoc", "expansionLoc"):
                self.file = where.get(name, {}).get("file", self.file)
            return None
        self.file = where.get("file", self.file)
        return (self.file, where["offset"], where["offset"] + where["tokLen"]) if "offset" in where else None

    def place(self, node):
        for name, value in list(node.items()):
            if name == "loc":
                self.location(value)
            elif name == "range":
                begin, end = self.location(value.get("begin", {})), self.location(value.get("end", {}))
                if begin and end and begin[0] == end[0]:
                    node["place"] = (begin[0], begin[1], end[2])
            elif name == "inner":
                for child in value:
                    self.place(child)
        if node.get("kind") == "VarDecl" and node.get("constexpr"):
            self.constants.add(node["id"])


class Finder:
    """Collects the points of one file."""

    def __init__(self, tree, path, text):
        self.tree, self.path = tree, path
        # Offsets of clang are bytes.
        self.bytes = text.encode()
        self.points = {}
        self.returns = ""
        for document in tree.documents:
            self.visit(document, None, 0)

    # The source between two offsets.
    def source(self, begin, end):
        return self.bytes[begin:end].decode()

    def span(self, node):
        place = node.get("place")
        return place[1:] if place and place[0] == self.path else None

    def snippet(self, begin, end):
        text = " ".join(self.source(begin, end).split())
        return text if len(text) <= 60 else text[:40] + " … " + text[-17:]

    def add(self, kind, span, depth, edits, *changes):
        self.points.setdefault((kind, *span), Point(span[0], span[1], depth, edits, list(changes)))

    def wrap(self, kind, span, depth, before, after, *changes):
        self.add(kind, span, depth, [(span[0], span[0], before, False), (span[1], span[1], after, True)], *changes)

    def visit(self, node, parent, depth):
        kind = node.get("kind")
        if not kind or kind in SKIPPED or node.get("isImplicit") or node.get("explicitlyDefaulted"):
            return
        if kind == "VarDecl" and node.get("constexpr"):
            return
        children = [c for c in node.get("inner", [])]
        place = node.get("place")
        if place and place[0] != self.path and kind not in ("NamespaceDecl",):
            return
        returns = self.returns
        if kind in FUNCTIONS and place and re.search(r"\bconsteval\b", self.source(place[1], place[1] + 80)):
            return
        if kind in FUNCTIONS:
            self.returns = node.get("type", {}).get("qualType", "")
            children = [c for c in children if c.get("kind") in ("ParmVarDecl", "CompoundStmt", "CXXCtorInitializer")]
        elif kind == "LambdaExpr":
            self.returns = ""
            children = [c for c in children if c.get("kind") == "CompoundStmt"]
        elif kind == "CXXForRangeStmt":
            children = [children[1], children[-1]]
        elif kind == "FunctionTemplateDecl":  # the pattern, and none of what is made from it
            children = [c for c in children if c.get("kind") in FUNCTIONS][:1]
        elif kind == "ClassTemplateDecl":
            children = [c for c in children if c.get("kind") == "CXXRecordDecl"]
        elif kind == "IfStmt" and node.get("isConstexpr"):
            children = children[1:]
        elif kind == "CaseStmt":
            children = children[1:]
        if self.span(node):
            self.consider(node, parent, depth)
        for child in children:
            self.visit(child, node, depth + 1)
        self.returns = returns

    def consider(self, node, parent, depth):
        kind = node["kind"]
        span = self.span(node)
        if kind in ("BinaryOperator", "CXXOperatorCallExpr", "CXXRewrittenBinaryOperator"):
            self.operation(node, span, depth)
        elif kind == "CompoundAssignOperator":
            self.operation(node, span, depth)
        elif kind == "UnaryOperator":
            self.unary(node, parent, span, depth)
        elif kind in ("IntegerLiteral", "FloatingLiteral", "CXXBoolLiteralExpr"):
            text = self.source(*span)
            if not re.match(r"^(\.?\d|true|false)", text):  # of what the standard library makes of an operator
                return
            self.wrap("value", span, depth, "::mutation::constant({0}, ", ")", f"`{text}` off by one")
        elif kind == "DeclRefExpr":
            self.named_constant(node, span, depth)
        elif kind == "ReturnStmt":
            self.returned(node, span, depth)
        elif kind == "CallExpr":
            self.call_of_std(node, span, depth)
        if kind in ("IfStmt", "ConditionalOperator", "WhileStmt") and not node.get("isConstexpr"):
            self.condition(node, depth)
        if parent and parent["kind"] in STATEMENT_PARENTS:
            self.statement(node, parent, span, depth)

    # The operands of an operation, in the order of the source.
    def operands(self, node, span):
        while node["kind"] == "CXXRewrittenBinaryOperator" or node.get("opcode") == "!":
            node = node["inner"][0]
        parts = [c for c in node.get("inner", []) if self.span(c)]
        if node["kind"] == "CXXOperatorCallExpr":
            parts = parts[1:]
            if len(parts) == 2 and "CXXOperatorCallExpr" == parts[0]["kind"] and self.span(parts[0]) == span:
                return None
        if len(parts) != 2:
            return None
        a, b = sorted((self.span(p) for p in parts))
        return (a, b) if a[0] == span[0] and b[1] == span[1] and a[1] <= b[0] else None

    def operation(self, node, span, depth):
        if node["kind"] == "CXXRewrittenBinaryOperator":
            inner = node["inner"][0]
            if inner["kind"] == "CXXOperatorCallExpr":  # of three-way comparison
                inner = next((c for c in inner["inner"] if c["kind"] == "CXXOperatorCallExpr"), inner)
                pair = self.operands(inner, span)
            else:
                pair = self.operands(node, span)
        else:
            pair = self.operands(node, span)
        if not pair:
            return
        (a0, a1), (b0, b1) = pair
        gap = self.source(a1, b0)
        op = re.sub(r"/\*.*?\*/|//[^\n]*", "", gap, flags=re.S).strip()
        if "//" in gap or "/*" in gap:
            return
        at = a1 + gap.encode().index(op.encode()) if op else a1
        token = (at, at + len(op))
        text = self.snippet(*span)
        if op in RELATIONS:
            name, shifted = RELATIONS[op]
            other = {"<": ">=", "<=": ">", ">": "<=", ">=": "<"}[op]
            self.call(span, depth, token, f"::mutation::{name}({{0}}, {{1}}, ",
                      f"`{text}` with {shifted}", f"`{text}` with {other}")
        elif op in ("==", "!="):
            self.wrap("op", span, depth, "::mutation::negated({0}, (", "))",
                      f"`{text}` with {'!=' if op == '==' else '=='}")
        elif op in ("&&", "||"):
            flip = "(::mutation::on({0}) != static_cast<bool>("
            self.add("op", span, depth,
                     [(span[0], span[0], "(::mutation::on({0}) != (" + flip, False), (a1, a1, "))", True),
                      (b0, b0, flip, False), (span[1], span[1], "))))", True)],
                     f"`{text}` with {'||' if op == '&&' else '&&'}")
        elif op in ARITHMETIC:
            name, other = ARITHMETIC[op]
            self.call(span, depth, token, f"::mutation::{name}({{0}}, ", f"`{text}` with {other}")
        elif op in ASSIGNMENTS:
            name, other = ASSIGNMENTS[op]
            self.call(span, depth, token, f"::mutation::{name}({{0}}, ", f"`{text}` with {other}")

    def call(self, span, depth, token, before, *changes):
        self.add("op", span, depth, [(span[0], span[0], before, False), (*token, ",", False),
                                     (span[1], span[1], ")", True)], *changes)

    def unary(self, node, parent, span, depth):
        op = node["opcode"]
        if not self.source(*span).startswith(op) or self.source(*span).startswith("!="):
            return
        token = (span[0], span[0] + len(op))
        text = self.snippet(*span)
        end = (span[1], span[1], ")", True)
        if op == "!":
            self.add("op", span, depth, [(*token, "::mutation::negated({0}, !", False), end], f"`{text}` without !")
        elif op in UNARY:
            self.add("op", span, depth, [(*token, f"::mutation::{UNARY[op]}({{0}}, ", False), end],
                     f"`{text}` without {op}")
        elif op in STEPS and not (parent and parent["kind"] == "ForStmt"):
            self.add("op", span, depth, [(*token, f"::mutation::{STEPS[op]}({{0}}, ", False), end],
                     f"`{text}` with {'--' if op == '++' else '++'}")

    def named_constant(self, node, span, depth):
        declared = node.get("referencedDecl", {})
        if declared.get("id") not in self.tree.constants:
            return
        if not NUMBER_TYPE.match(node.get("type", {}).get("qualType", "")):
            return
        self.wrap("value", span, depth, "::mutation::constant({0}, ", ")",
                  f"`{self.snippet(*span)}` off")

    def returned(self, node, span, depth):
        value = next((c for c in node.get("inner", []) if self.span(c)), None)
        result = self.returns.split("(")[0].strip()
        if value is None or not self.returns or result in ("void", "auto", "decltype(auto)") or result.endswith("&"):
            return
        begin, end = self.span(value)
        text = self.source(begin, end)
        if text.startswith("{") or text in ("true", "false", "std::nullopt", "nullptr", "*this"):
            return
        inner = value
        while inner["kind"] in ("ExprWithCleanups", "ImplicitCastExpr", "ParenExpr", "MaterializeTemporaryExpr",
                                "CXXBindTemporaryExpr") and inner.get("inner"):
            inner = inner["inner"][0]
        if inner["kind"] in ("IntegerLiteral", "FloatingLiteral", "CXXRewrittenBinaryOperator"):
            return
        if result == "bool" and (inner.get("opcode") in {*RELATIONS, "==", "!=", "&&", "||", "!"}):
            return
        name = "negated" if result == "bool" else "returned"
        self.wrap("return", (begin, end), depth, f"::mutation::{name}({{0}}, ", ")",
                  f"`return {self.snippet(begin, end)}` returns something else")

    def call_of_std(self, node, span, depth):
        callee, *arguments = [c for c in node.get("inner", []) if self.span(c)]
        begin, end = self.span(callee)
        called = self.source(begin, end)
        match = re.match(r"^std::(min|max|clamp|abs|fabs)(<.*>)?$", called, re.S)
        opening = self.source(end, end + 1)
        if not match or opening != "(" or not arguments or self.source(*self.span(arguments[0])).startswith("{"):
            return
        text, typed = self.snippet(*span), match[2] or ""
        name, numbers, changes = {
            "min": ("least", "{0}", [f"`{text}` with max"]), "max": ("greatest", "{0}", [f"`{text}` with min"]),
            "clamp": ("clamped", "{0}, {1}", [f"`{text}` open below", f"`{text}` open above"])}.get(
                match[1], ("magnitude", "{0}", [f"`{text}` keeps the sign"]))
        self.add("op", span, depth, [(begin, end + 1, f"::mutation::{name}{typed}({numbers}, ", False)], *changes)

    def condition(self, node, depth):
        if node.get("hasVar") or node.get("hasInit") or not node.get("inner"):
            return
        condition = node["inner"][0]
        while condition["kind"] in ("ExprWithCleanups", "ImplicitCastExpr") and condition.get("inner"):
            if not self.span(condition["inner"][0]):
                break
            condition = condition["inner"][0]
        span = self.span(condition)
        if not span or condition.get("opcode") in {*RELATIONS, "==", "!=", "&&", "||", "!"} or condition["kind"] in (
                "CXXRewrittenBinaryOperator", "CXXBoolLiteralExpr", "DeclStmt", "IntegerLiteral"):
            return
        if re.search(r"[^=!<>]=[^=]|[<>]=?|==|!=", re.sub(r"<[\w:, ]+>", "", self.source(*span))) and condition[
                "kind"] == "CXXOperatorCallExpr":
            return
        self.wrap("op", span, depth, "::mutation::negated({0}, ", ")", f"condition `{self.snippet(*span)}` negated")

    def statement(self, node, parent, span, depth):
        kind = node["kind"]
        is_expression = kind.endswith(("Expr", "Operator")) or kind in ("ExprWithCleanups",)
        if not is_expression or kind in NOT_DELETED:
            return
        if parent["kind"] in ("IfStmt", "ForStmt", "WhileStmt", "CXXForRangeStmt", "DoStmt"):
            first_line = self.source(self.span(parent)[0], span[0])
            if not first_line.rstrip().endswith((")", "else", "do")):  # it is the condition or a step
                return
            if parent["kind"] in ("ForStmt", "WhileStmt", "IfStmt") and node is not parent["inner"][-1] and not (
                    parent["kind"] == "IfStmt" and node is parent["inner"][-2] and parent.get("hasElse")):
                return
        rest = self.source(span[1], span[1] + 40)
        if not rest.lstrip().startswith(";"):
            return
        end = span[1] + len(rest[:rest.index(";")].encode()) + 1
        self.add("statement", (span[0], end), depth, [(span[0], span[0], "{{if (!::mutation::on({0})) {{", False),
                                                      (end, end, "}}}}", True)],
                 f"`{self.snippet(*span)}` deleted")


def find_points(tree, path, text):
    """The points of a file in the order of the source."""
    finder = Finder(tree, path, text)
    points = sorted(finder.points.values(), key=lambda p: (p.begin, -p.end, p.depth))
    return [p for p in points if not crossed(p, points)]


def crossed(point, points):
    return any(p.begin < point.begin < p.end < point.end for p in points)


def apply(text, points, numbers):
    """The source with the switches in; numbers[i] are the ids of points[i], or None to leave it out."""
    data = text.encode()
    edits = []
    for rank, (point, ids) in enumerate(zip(points, numbers)):
        if ids is None:
            continue
        for begin, end, replacement, closes in point.edits:
            # Of what closes here the innermost comes first; of what opens here the outermost.
            order = (0, -rank) if closes else (1, rank)
            edits.append((begin, order, end, replacement.format(*ids)))
    edits.sort()
    out, at = [], 0
    for begin, _, end, replacement in edits:
        out.append(data[at:begin])
        out.append(replacement.encode())
        at = max(at, end)
    out.append(data[at:])
    return b"".join(out).decode()
