"""Lines of C++, and names for what stands in them."""
import re

from .parse import Failure


class Value:
    """code: a C++ expression without side effects. variable: the one that it is, or is a part of.

    What an assignment to it needs besides: swizzled, (the vector, which components); picked, (the array or vector, the
    index that varies); memory, (the open array, the index)."""

    def __init__(self, code, type, varying, variable=None, swizzled=None, picked=None, memory=None):
        self.code, self.type, self.varying, self.variable = code, type, varying, variable
        self.swizzled, self.picked, self.memory = swizzled, picked, memory


class Writer:
    """The text of one function, line by line."""

    def __init__(self):
        self.lines, self.depth, self.n_names = [], 1, 0

    def line(self, text):
        self.lines.append("    " * self.depth + text)

    def fresh(self, stem):
        self.n_names += 1
        return "%s_%d" % (stem, self.n_names)

    def fail(self, node, what):
        raise Failure("%s: %s" % (node.place, what))

    def taken(self, code):
        """The expression that the last line has put into the variable `code`, in place of that line: nothing lies
        between."""
        found = re.match(r"\s*const auto (\w+) = (.*);$", self.lines[-1]) if self.lines else None
        if found and found[1] == code:
            self.lines.pop()
            return found[2]
        return code

    def stored(self, value):
        """The value in a C++ variable, so that it is computed once."""
        name = self.fresh("t")
        self.line("const auto %s = %s;" % (name, value.code))
        return Value(name, value.type, value.varying)
