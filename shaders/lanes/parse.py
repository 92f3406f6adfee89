"""Reads the GLSL of shaders/, after the preprocessor, into a tree.

The dialect is what shaders/ uses: no switch, no do, no preprocessor lines left but those that say where the text is
from (# LINE "FILE"); one declarator list a line of declarations; README.md lists it. A text outside of it is refused
with its place."""
import re

TOKEN = re.compile(r"""
    (?P<mark>^\#\ \d+\ "[^"]*"[^\n]*\n)
  | (?P<space>\s+|//[^\n]*|/\*.*?\*/)
  | (?P<number>0[xX][0-9a-fA-F]+[uU]?|(?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][-+]?\d+)?|\d+[uU]?)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<op><<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\+=|-=|\*=|/=|%=|&=|\|=|\^=|[-+*/%<>=!&|^~?:;,.(){}\[\]])
""", re.X | re.S | re.M)

SCALARS = ("float", "int", "uint", "bool", "double")
PREFIX = {"": "float", "i": "int", "u": "uint", "b": "bool", "d": "double"}
OPAQUE = ("image2D", "uimage2D", "sampler2D", "usampler2D", "samplerBuffer", "usamplerBuffer")
QUALIFIERS = ("const", "in", "out", "inout", "uniform", "buffer", "readonly", "writeonly", "flat", "shared",
              "restrict", "coherent")


class Failure(Exception):
    """A text that is outside of the dialect."""


class Type:
    """base: float, int, uint, bool, double, void, a struct's or an opaque type's name. rows: 1 for a scalar,
    columns: above 0 for a matrix. size: of an array, None where it is none, -1 where it is open."""

    def __init__(self, base, rows=1, columns=0, size=None):
        self.base, self.rows, self.columns, self.size = base, rows, columns, size

    def key(self):
        return (self.base, self.rows, self.columns, self.size)

    def __eq__(self, other):
        return isinstance(other, Type) and self.key() == other.key()

    def __hash__(self):
        return hash(self.key())

    def __repr__(self):
        return "%s%d%d[%s]" % self.key()

    def element(self):
        """What an index selects."""
        if self.size is not None:
            return Type(self.base, self.rows, self.columns)
        return Type(self.base, self.rows) if self.columns else Type(self.base)

    def array(self, size):
        return Type(self.base, self.rows, self.columns, size)

    @property
    def is_number(self):
        return self.base in SCALARS

    @property
    def is_scalar(self):
        return self.is_number and self.rows == 1 and self.size is None


def named_type(name):
    if name in SCALARS or name == "void" or name in OPAQUE:
        return Type(name)
    vector = re.fullmatch(r"([iubd]?)vec([234])", name)
    if vector:
        return Type(PREFIX[vector[1]], int(vector[2]))
    matrix = re.fullmatch(r"mat([234])", name)
    return Type("float", int(matrix[1]), int(matrix[1])) if matrix else None


class Node:
    """kind, place, and what the kind says: see where each is made."""

    def __init__(self, kind, place, **fields):
        self.kind, self.place = kind, place
        self.__dict__.update(fields)


BINARY = [("||",), ("&&",), ("|",), ("^",), ("&",), ("==", "!="), ("<", ">", "<=", ">="), ("<<", ">>"),
          ("+", "-"), ("*", "/", "%")]
ASSIGN = ("=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=")


class Parser:
    """Of one program's text: globals in `items`, in their order."""

    def __init__(self, text):
        self.tokens, self.at, self.structs, self.items = [], 0, {}, []
        self.local_size = None  # invocations of a workgroup
        self.split(text)
        while self.peek() != "":
            self.item()

    def split(self, text):
        """Into tokens with their places."""
        at, file, line = 0, "line ", 1
        while at < len(text):
            match, place = TOKEN.match(text, at), "%s%d" % (file, line)
            if not match:
                raise Failure("%s: %r is no token" % (place, text[at:at + 20].split("\n")[0]))
            if match.lastgroup not in ("space", "mark"):
                self.tokens.append((match.lastgroup, match[0], place))
            line += match[0].count("\n")
            if match.lastgroup == "mark":
                _, number, name = match[0].split(" ", 2)
                file, line = name.split('"')[1] + ":", int(number)
            at = match.end()
        self.tokens.append(("end", "", "%s%d" % (file, line)))

    # --- tokens
    def peek(self, ahead=0):
        return self.tokens[min(self.at + ahead, len(self.tokens) - 1)][1]

    @property
    def place(self):
        return self.tokens[self.at][2]

    def fail(self, what):
        raise Failure("%s: %s, not %r" % (self.place, what, self.peek()))

    def take(self):
        self.at += 1
        return self.tokens[self.at - 1][1]

    def accept(self, text):
        if self.peek() == text:
            self.at += 1
            return True
        return False

    def expect(self, text):
        if not self.accept(text):
            self.fail("%r is wanted" % text)

    def name(self):
        if self.tokens[self.at][0] != "name":
            self.fail("a name is wanted")
        return self.take()

    # --- types and declarations
    def type_at(self, ahead=0):
        name = self.peek(ahead)
        return Type(name) if name in self.structs else named_type(name)

    def type(self):
        kind = self.type_at()
        if not kind:
            self.fail("a type is wanted")
        self.take()
        return self.dimension(kind)

    def dimension(self, kind):
        if not self.accept("["):
            return kind
        size = None if self.peek() == "]" else self.ternary()
        self.expect("]")
        return kind.array(size if size is not None else -1)

    def qualifiers(self):
        found = set()
        while True:
            if self.accept("layout"):
                self.expect("(")
                while not self.accept(")"):
                    if self.take() == "local_size_x":
                        self.expect("=")
                        self.local_size = self.ternary()
                        continue
                    found.add(self.tokens[self.at - 1][1])
            elif self.peek() in QUALIFIERS:
                found.add(self.take())
            else:
                return found

    def item(self):
        if self.accept(";"):
            return
        place, qualifiers = self.place, self.qualifiers()
        if self.accept(";"):
            return  # layout(...) in;
        if self.accept("struct"):
            name = self.name()
            self.structs[name] = None
            self.structs[name] = self.members()
            self.expect(";")
            self.items.append(Node("struct", place, name=name, members=self.structs[name]))
            return
        if ("uniform" in qualifiers or "buffer" in qualifiers) and self.peek(1) == "{":
            self.block(place, qualifiers)
            return
        kind, name = self.type(), self.name()
        if self.accept("("):
            self.function(place, kind, name)
            return
        for decl in self.declarators(place, kind, name):
            self.items.append(Node("global", place, decl=decl, qualifiers=qualifiers))

    def block(self, place, qualifiers):
        name, members = self.name(), self.members()
        instance = None if self.peek() == ";" else self.name()
        self.expect(";")
        self.items.append(Node("block", place, name=name, members=members, instance=instance,
                               is_buffer="buffer" in qualifiers))

    def members(self):
        found = []
        self.expect("{")
        while not self.accept("}"):
            self.qualifiers()
            place, kind = self.place, self.type()
            found += [(decl.name, decl.type) for decl in self.declarators(place, kind, self.name())]
        return found

    def declarators(self, place, kind, name):
        found = []
        while True:
            whole = self.dimension(kind)
            value = self.assignment() if self.accept("=") else None
            found.append(Node("decl", place, name=name, type=whole, value=value))
            if not self.accept(","):
                break
            name = self.name()
        self.expect(";")
        return found

    def function(self, place, kind, name):
        params = []
        while not self.accept(")"):
            qualifiers, of = self.qualifiers(), self.type()
            param = self.name()
            params.append(Node("param", place, name=param, type=self.dimension(of),
                               way="inout" if "inout" in qualifiers else "out" if "out" in qualifiers else "in"))
            self.accept(",")
        body = None if self.accept(";") else self.compound()
        if body:
            self.items.append(Node("function", place, type=kind, name=name, params=params, body=body))

    # --- statements
    def compound(self):
        place, body = self.place, []
        self.expect("{")
        while not self.accept("}"):
            body.append(self.statement())
        return Node("compound", place, body=body)

    def statement(self):
        place = self.place
        if self.peek() == "{":
            return self.compound()
        if self.accept(";"):
            return Node("compound", place, body=[])
        if self.accept("if"):
            self.expect("(")
            test = self.expression()
            self.expect(")")
            then = self.statement()
            other = self.statement() if self.accept("else") else None
            return Node("if", place, test=test, then=then, other=other)
        if self.accept("for"):
            self.expect("(")
            first = None if self.accept(";") else self.simple()
            test = None if self.peek() == ";" else self.expression()
            self.expect(";")
            step = None if self.peek() == ")" else self.expression()
            self.expect(")")
            return Node("loop", place, first=first, test=test, step=step, body=self.statement(), diverges=False)
        if self.accept("while"):
            self.expect("(")
            test = self.expression()
            self.expect(")")
            return Node("loop", place, first=None, test=test, step=None, body=self.statement(), diverges=False)
        if self.peek() in ("return", "break", "continue"):
            kind = self.take()
            value = self.expression() if kind == "return" and self.peek() != ";" else None
            self.expect(";")
            return Node(kind, place, value=value)
        return self.simple()

    def simple(self):
        """A declaration or an expression, with its semicolon."""
        place = self.place
        self.accept("const")
        if self.type_at() and self.tokens[self.at + 1][0] == "name":
            kind = self.type()
            return Node("declare", place, decls=self.declarators(place, kind, self.name()))
        value = self.expression()
        self.expect(";")
        return Node("expression", place, value=value)

    # --- expressions
    def expression(self):
        value = self.assignment()
        if self.peek() == ",":
            self.fail("no comma operator")
        return value

    def assignment(self):
        place, left = self.place, self.ternary()
        if self.peek() in ASSIGN:
            op = self.take()
            return Node("assign", place, op=op[:-1], left=left, right=self.assignment())
        return left

    def ternary(self):
        place, test = self.place, self.binary(0)
        if not self.accept("?"):
            return test
        yes = self.assignment()
        self.expect(":")
        return Node("ternary", place, test=test, yes=yes, no=self.assignment())

    def binary(self, level):
        if level == len(BINARY):
            return self.unary()
        left = self.binary(level + 1)
        while self.peek() in BINARY[level]:
            place, op = self.place, self.take()
            left = Node("binary", place, op=op, left=left, right=self.binary(level + 1))
        return left

    def unary(self):
        place = self.place
        if self.peek() in ("-", "+", "!", "~", "++", "--"):
            op = self.take()
            return Node("step" if len(op) == 2 else "unary", place, op=op, of=self.unary(), is_post=False)
        return self.postfix(self.primary())

    def postfix(self, value):
        while True:
            place = self.place
            if self.accept("."):
                value = Node("member", place, of=value, name=self.name())
            elif self.accept("["):
                value = Node("index", place, of=value, at=self.expression())
                self.expect("]")
            elif self.peek() in ("++", "--"):
                value = Node("step", place, op=self.take(), of=value, is_post=True)
            else:
                return value

    def arguments(self):
        found = []
        while not self.accept(")"):
            found.append(self.assignment())
            self.accept(",")
        return found

    def primary(self):
        place = self.place
        kind, text, _ = self.tokens[self.at]
        if self.accept("("):
            value = self.expression()
            self.expect(")")
            return value
        if kind == "number":
            self.take()
            return Node("number", place, text=text)
        if kind != "name":
            self.fail("a value is wanted")
        of = self.type_at()
        if of:
            of = self.type()
            self.expect("(")
            return Node("construct", place, type=of, arguments=self.arguments())
        self.take()
        if text in ("true", "false"):
            return Node("bool", place, text=text)
        if self.accept("("):
            return Node("call", place, name=text, arguments=self.arguments())
        return Node("name", place, name=text)
