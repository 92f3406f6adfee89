"""Random programs in the dialect of shaders/lanes, and an interpreter that runs them, one invocation at a time."""
import random

from lanes_host import STRIDE, WHOLE

MASK = 2**32 - 1
FUNCTIONS = 3
MOST_STEPS = 400  # a program that takes more steps is replaced by another


class Break(Exception):
    pass


class Continue(Exception):
    pass


class TooLong(Exception):
    pass


class Return(Exception):
    def __init__(self, value):
        super().__init__()
        self.value = value


OPERATIONS = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b, "&": lambda a, b: a & b,
    "|": lambda a, b: a | b, "^": lambda a, b: a ^ b, "<<": lambda a, b: a << (b & 31), ">>": lambda a, b: a >> (b & 31),
    "/": lambda a, b: a // (b | 1), "%": lambda a, b: a % (b | 1),
}
TESTS = {"<": lambda a, b: a < b, ">=": lambda a, b: a >= b, "==": lambda a, b: a == b, "!=": lambda a, b: a != b}


class Maker:
    """Makes programs as trees of tuples. All variables are unsigned integers; each name is declared once."""

    def __init__(self, random_numbers):
        self.random, self.n_names = random_numbers, 0

    def pick(self, *choices):
        return self.random.choice(choices)

    def name(self, stem):
        self.n_names += 1
        return "%s%d" % (stem, self.n_names)

    # `names`: that may be read. n_functions: the first so many may be called.
    def value(self, names, n_functions, depth=2):
        kind = self.random.random()
        if depth == 0 or kind < 0.3:
            return self.pick(("name", self.pick(*names)), ("number", self.random.randrange(20)), ("name", "stride"),
                             ("element", ("name", self.pick(*names))))
        deeper = lambda: self.value(names, n_functions, depth - 1)  # noqa: E731
        if kind < 0.45 and n_functions:
            return ("call", self.random.randrange(n_functions), deeper(), deeper())
        if kind < 0.55:
            return ("choice", self.test(names, n_functions, depth - 1), deeper(), deeper())
        return ("operation", self.pick(*OPERATIONS), deeper(), deeper())

    def test(self, names, n_functions, depth=2):
        if depth and self.random.random() < 0.35:
            return ("both", self.pick("&&", "||"), self.test(names, n_functions, depth - 1),
                    self.test(names, n_functions, depth - 1))
        return ("test", self.pick(*TESTS), self.value(names, n_functions, 1), self.value(names, n_functions, 1))

    def body(self, names, n_functions, depth, in_loop, returns):
        names, found = list(names), []
        for _ in range(self.random.randrange(2, 5)):
            found.append(self.statement(names, n_functions, depth, in_loop, returns))
        return found

    def statement(self, names, n_functions, depth, in_loop, returns):
        kind = self.random.random()
        value = lambda: self.value(names, n_functions)  # noqa: E731
        if kind < 0.05 and n_functions:
            plain = lambda: self.value(names, 0)  # noqa: E731
            return ("change", self.pick(*[name for name in names if name[0] != "k"]), self.random.randrange(n_functions), plain(),
                    plain())
        if depth == 0 or kind < 0.35:
            if kind < 0.1:
                statement = ("declare", self.name("v"), value())
                names.append(statement[1])
                return statement
            if kind < 0.17:
                return ("store", value(), value())
            return ("assign", self.pick(*[name for name in names if name[0] != "k"]), self.pick("", "+", "^", "*"), value())
        if kind < 0.65:
            return ("if", self.test(names, n_functions), self.body(names, n_functions, depth - 1, in_loop, returns),
                    self.pick(None, self.body(names, n_functions, depth - 1, in_loop, returns)))
        if kind < 0.8:
            counter = self.name("k")
            return ("for", counter, value(),
                    self.body(names + [counter], n_functions, depth - 1, True, returns))
        if kind < 0.93 and in_loop:
            return ("if", self.test(names, n_functions), [(self.pick("break", "continue"),)], None)
        if returns:
            return ("if", self.test(names, n_functions), [("return", value())], None)
        return ("assign", names[0], "+", value())

    def function(self, k):
        names = ["a", "b"]
        return self.body(names, k, 2, False, True) + [("return", self.value(names, k))]


def text_of(node):
    """Evaluates an expression."""
    kind = node[0]
    if kind == "name":
        return node[1]
    if kind == "number":
        return "%du" % node[1]
    if kind == "element":
        return "kept[%s & 3u]" % text_of(node[1])
    if kind == "call":
        return "pure%d(%s, %s, kept)" % (node[1], text_of(node[2]), text_of(node[3]))
    if kind == "choice":
        return "(%s ? %s : %s)" % tuple(text_of(part) for part in node[1:])
    left, right = text_of(node[2]), text_of(node[3])
    if node[0] == "operation" and node[1] in ("<<", ">>"):
        right = "(%s & 31u)" % right
    elif node[0] == "operation" and node[1] in ("/", "%"):
        right = "(%s | 1u)" % right
    return "(%s %s %s)" % (left, node[1], right)


def lines_of(body, depth=1):
    for node in body:
        kind, pad = node[0], "    " * depth
        if kind == "declare":
            yield pad + "uint %s = %s;" % (node[1], text_of(node[2]))
        elif kind == "store":
            yield pad + "kept[%s & 3u] = %s;" % (text_of(node[1]), text_of(node[2]))
        elif kind == "assign":
            yield pad + "%s %s= %s;" % (node[1], node[2], text_of(node[3]))
        elif kind == "change":
            yield pad + "%s = change%d(%s, %s, kept);" % (node[1], node[2], text_of(node[3]), text_of(node[4]))
        elif kind == "if":
            yield pad + "if (%s) {" % text_of(node[1])
            yield from lines_of(node[2], depth + 1)
            if node[3]:
                yield pad + "} else {"
                yield from lines_of(node[3], depth + 1)
            yield pad + "}"
        elif kind == "for":
            yield pad + "for (uint %s = 0u; %s < (%s & 3u); %s++) {" % (node[1], node[1], text_of(node[2]), node[1])
            yield from lines_of(node[3], depth + 1)
            yield pad + "}"
        elif kind == "return":
            yield pad + "return %s;" % text_of(node[1])
        else:
            yield pad + kind + ";"


class Run:
    """Runs one invocation. `kept` is the array that the running function reads and changes."""

    def __init__(self, functions):
        self.functions, self.kept, self.steps = functions, [1, 2, 3, 4], 0

    def value(self, node, names):
        kind = node[0]
        if kind == "name":
            return names[node[1]]
        if kind == "number":
            return node[1]
        if kind == "element":
            return self.kept[self.value(node[1], names) & 3]
        if kind == "choice":
            return self.value(node[2] if self.value(node[1], names) else node[3], names)
        if kind == "both":
            left = self.value(node[2], names)
            return left and self.value(node[3], names) if node[1] == "&&" else left or self.value(node[3], names)
        if kind == "call":
            before = list(self.kept)
            result = self.call(node[1], node[2:], names)
            self.kept = before
            return result
        left, right = self.value(node[2], names), self.value(node[3], names)
        return TESTS[node[1]](left, right) if kind == "test" else OPERATIONS[node[1]](left, right) & MASK

    def call(self, k, arguments, names):
        a, b = (self.value(argument, names) for argument in arguments)
        try:
            self.run(self.functions[k], {"a": a, "b": b, "stride": STRIDE})
        except Return as returned:
            return returned.value
        raise AssertionError("a function without a return")

    def run(self, body, names):
        for node in body:
            self.steps += 1
            if self.steps > MOST_STEPS:
                raise TooLong
            kind = node[0]
            if kind == "declare":
                names[node[1]] = self.value(node[2], names)
            elif kind == "store":
                self.kept[self.value(node[1], names) & 3] = self.value(node[2], names)
            elif kind == "assign":
                value = self.value(node[3], names)
                names[node[1]] = OPERATIONS[node[2]](names[node[1]], value) & MASK if node[2] else value
            elif kind == "change":
                names[node[1]] = self.call(node[2], node[3:], names)
            elif kind == "if":
                self.run(node[2] if self.value(node[1], names) else node[3] or [], names)
            elif kind == "for":
                self.loop(node, names)
            elif kind == "return":
                raise Return(self.value(node[1], names))
            else:
                raise Break() if kind == "break" else Continue()

    def loop(self, node, names):
        names[node[1]] = 0
        while names[node[1]] < self.value(node[2], names) & 3:
            try:
                self.run(node[3], names)
            except Break:
                return
            except Continue:
                pass
            names[node[1]] += 1


def invocation(functions, i):
    run = Run(functions)
    result = run.call(FUNCTIONS - 1, (("number", WHOLE[0][i]), ("number", WHOLE[1][i])), {})
    a, b, c, d = run.kept
    return result, (a + 3 * b + 5 * c + 7 * d) & MASK


def random_program(seed):
    """(text, values of invocation i) of a program that does not take too many steps."""
    for attempt in range(1000):
        maker = Maker(random.Random("%d %d" % (seed, attempt)))
        functions = [maker.function(k) for k in range(FUNCTIONS)]
        try:
            results = [invocation(functions, i) for i in range(len(WHOLE[0]))]
        except TooLong:
            continue
        text = ""
        for k, body in enumerate(functions):
            lines = "\n".join(lines_of(body))
            for name, way in (("pure", ""), ("change", "inout ")):
                text += "uint %s%d(uint a, uint b, %suint kept[4])\n{\n%s\n}\n" % (name, k, way, lines)
        text += """void main() { uint kept[4] = uint[4](1u, 2u, 3u, 4u);
    uint result = change%d(whole_in(0), whole_in(1), kept);
    put(result, kept[0] + 3u * kept[1] + 5u * kept[2] + 7u * kept[3]); }\n""" % (FUNCTIONS - 1)
        return text, results.__getitem__
    raise AssertionError("every program takes too long")
