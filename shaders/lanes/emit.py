"""Writes a program's tree as C++ whose every value holds one invocation in each lane of a vector.

A value is uniform where it is the same in all lanes (a plain C++ value) or varying (a vector). What is uniform is
found by inference: a variable becomes varying when a varying value is assigned to it, or any value where only some
lanes are active. A function is written once for each pattern of uniform and varying arguments that it is called with.

Control flow that varies runs under masks. A region is a part of a function in which the same lanes are active, m<k> its
mask. An assignment to a variable of an outer region keeps the old value in the lanes that are not active; within its own
region a variable is assigned whole, since nobody reads the lanes that are not active there. Return, break and continue
take lanes out of the masks around. A branch whose mask is empty is skipped.

An operand of &&, || or ?: that calls one of the program's functions runs under a mask, too; any other is computed in
all lanes, since it is cheap and changes nothing."""
import operator
import re

from .cpp import TEXEL, UINT, VOID, always_varies, cpp_type
from .parse import Failure, Type
from .scope import Region, Variable
from .statements import Statements


class Instance:
    """A function for one pattern of uniform and varying arguments."""

    def __init__(self, node, varying, name):
        self.node, self.varying, self.name = node, varying, name
        self.returns_varying, self.known = False, {}
        self.is_done = False  # in this round
        self.is_open = False  # while it is written
        self.headers, self.text, self.kept = [], "", []


class Emitter:
    """Finds out which instances of which functions main() needs, and writes them until nothing more turns out to vary."""

    def __init__(self, parser):
        self.parser, self.instances, self.order = parser, {}, []
        self.structs = parser.structs
        self.functions, self.globals, self.changed = {}, {}, True
        for item in parser.items:
            if item.kind == "function":
                self.functions.setdefault(item.name, []).append(item)
            elif item.kind == "global":
                self.add_global(item)
            elif item.kind == "block":
                self.add_block(item)
        self.globals["gl_WorkGroupID"] = Variable("gl_WorkGroupID", Type("uint", 3), False, None)
        self.globals["gl_LocalInvocationIndex"] = Variable("gl_LocalInvocationIndex", UINT, True, None)

    # --- globals
    def constant(self, node):
        """The number that a constant expression of integers comes to."""
        operations = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": lambda a, b: a // max(b, 1)}
        if isinstance(node, int):
            return node
        if node.kind == "number":
            return int(node.text.rstrip("uU"), 0)
        if node.kind == "name":
            for item in self.parser.items:
                if item.kind == "global" and item.decl.name == node.name and "const" in item.qualifiers:
                    return self.constant(item.decl.value)
        if node.kind == "binary" and node.op in operations:
            return operations[node.op](self.constant(node.left), self.constant(node.right))
        raise Failure("%s: no constant" % node.place)

    def settle(self, of):
        """The type with its size as a number."""
        if of.size is None or of.size == -1:
            return of
        return Type(of.base, of.rows, of.columns, self.constant(of.size))

    def add_global(self, item):
        of = self.settle(item.decl.type)
        name = item.decl.name
        if of.base in TEXEL and of.size not in (None, 1):
            raise Failure("%s: an array of textures has one" % item.place)
        if re.fullmatch(r"kept|live|result|m\d+", name):
            raise Failure("%s: %s is a name of the C++ that is written" % (item.place, name))
        self.globals[name] = Variable(name, of, False, None)
        self.globals[name].is_memory = "shared" in item.qualifiers

    def add_block(self, item):
        if any(of.size == -1 for _, of in item.members[:-1]):
            raise Failure("%s: the open array of a block is its last member" % item.place)
        for name, of in item.members:
            variable = Variable("%s->%s" % (item.instance or item.name, name), self.settle(of), False, None)
            variable.is_memory = of.size == -1
            self.globals[item.instance + "." + name if item.instance else name] = variable

    # --- functions
    def instance(self, node, varying):
        key = (id(node), varying)
        if key not in self.instances:
            mark = "".join("v" if v else "u" for v in varying)
            number = sum(1 for i in self.instances.values() if i.node.name == node.name)
            self.instances[key] = Instance(node, varying, "%s_%s%d" % (node.name, mark, number))
            self.changed = True
        return self.instances[key]

    def program(self):
        """The text of every instance that main() needs, callees first."""
        main = self.instance(self.functions["main"][0], ())
        while self.changed:
            self.changed, self.order = False, []
            for known in list(self.instances.values()):
                known.is_done = False
            self.emit(main)
        return main

    def emit(self, instance):
        if instance.is_done:
            return
        instance.is_done = instance.is_open = True
        while True:
            before = dict(instance.known), instance.returns_varying
            Function(self, instance).emit()
            if before == (instance.known, instance.returns_varying):
                break
            self.changed = True
        instance.is_open = False
        self.order.append(instance)


class Function(Statements):
    """Writes one instance, by what is known so far; notes what turned out to vary."""

    def emit(self):
        self.region = self.top = Region("m0", None)
        params = ["vbool m0"]
        self.has_barrier = any(part.kind == "expression" and part.value.kind == "call" and part.value.name == "barrier"
                               for part in self.node.body.body)
        if self.has_barrier:
            params.append("kept_by_main &kept")
        for param, varying in zip(self.node.params, self.instance.varying):
            of = self.whole.settle(param.type)
            varying = varying or param.way != "in" or always_varies(of)
            key = "param " + param.name
            varying = self.note(key, varying)
            self.scopes[-1][param.name] = Variable(param.name + "_", of, varying, self.top, key)
            self.scopes[-1][param.name].is_out = param.way != "in"
            params.append(self.param_text(of, varying, param))
        returns = self.whole.settle(self.node.type)
        varying = self.instance.returns_varying or always_varies(returns)
        self.returns = returns
        of = "void" if returns == VOID else cpp_type(returns, varying)
        self.compound(self.node.body)
        if self.may_return:
            self.lines.insert(0, "    vbool live = m0;")
            if returns != VOID:
                self.lines.insert(0, "    %s result = {};" % of)
                self.line("return result;")
        self.instance.kept = self.kept
        self.instance.headers, self.instance.text = [], ""
        parts = self.parts + [self.lines]
        for i, lines in enumerate(parts):
            name = self.instance.name + ("_part%d" % i if len(parts) > 1 else "")
            self.instance.headers.append("%s %s(%s)" % (of, name, ", ".join(params)))
            self.instance.text += "%s\n{\n%s\n}\n\n" % (self.instance.headers[-1], "\n".join(lines))

    def param_text(self, of, varying, param):
        """By reference where the function does not change it, but for what one register holds."""
        kind = cpp_type(of, varying)
        if param.way != "in":
            return "%s &%s_" % (kind, param.name)
        if of.is_scalar or self.instance.known.get("changed " + param.name):
            return "%s %s_" % (kind, param.name)
        return "const %s &%s_" % (kind, param.name)
