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
import re

from .parse import Failure, Node, Type

FLOAT, INT, UINT, BOOL, VOID = Type("float"), Type("int"), Type("uint"), Type("bool"), Type("void")
LANE = {"float": "vfloat", "int": "vint", "uint": "vuint", "bool": "vbool", "double": "vdouble"}
PLAIN = {"float": "float", "int": "int32_t", "uint": "uint32_t", "bool": "bool", "double": "double"}

# Built-in functions by their result: "same" as the widest argument, "scalar" of its base, or a type.
BUILTINS = {
    **{name: "same" for name in (
        "abs sign floor ceil round fract min max clamp mix step smoothstep sqrt inversesqrt pow exp2 log2 cross "
        "normalize ldexp transpose").split()},
    **{name: "scalar" for name in "dot length distance".split()},
    **{name: "bools" for name in ("lessThan lessThanEqual greaterThan greaterThanEqual").split()},
    "any": BOOL, "all": BOOL, "bitCount": INT, "findLSB": INT, "floatBitsToUint": "uints",
    "uintBitsToFloat": "floats", "packDouble2x32": Type("double"),
}
MEMORY = ("texelFetch", "textureLod", "textureSize", "imageLoad", "imageStore", "atomicAdd", "atomicMax", "barrier",
          "frexp", "makeTexels")
# What an image or a texture holds.
TEXEL = {"image2D": Type("float", 4), "uimage2D": Type("uint", 4), "sampler2D": Type("float", 4),
         "usampler2D": Type("uint", 4), "samplerBuffer": Type("float", 4), "usamplerBuffer": Type("uint", 4)}


class Value:
    """code: a C++ expression without side effects. place: what an assignment needs, of what may be assigned."""

    def __init__(self, code, type, varying, variable=None):
        self.code, self.type, self.varying, self.variable = code, type, varying, variable


class Variable:
    """region: where it was declared, None for a global."""

    def __init__(self, code, type, varying, region, key=None):
        self.code, self.type, self.varying, self.region, self.key = code, type, varying, region, key
        self.is_memory = False  # a buffer's open array, or what a workgroup shares
        self.is_out = False  # a parameter that the caller reads afterwards


class Region:
    """mask: the C++ variable. loop: the innermost loop around that diverges."""

    def __init__(self, mask, loop):
        self.mask, self.loop = mask, loop


class Loop:
    def __init__(self, alive, body, diverges, region, label):
        self.alive, self.body, self.diverges, self.region, self.label = alive, body, diverges, region, label
        self.continues = False


class Instance:
    """A function for one pattern of uniform and varying arguments."""

    def __init__(self, node, varying, name):
        self.node, self.varying, self.name = node, varying, name
        self.returns_varying, self.known, self.text = False, {}, ""


def cpp_type(of, varying):
    """`of` with lanes where it varies; structs always hold lanes."""
    if of.size is not None:
        return "array<%s, %s>" % (cpp_type(of.element(), varying), of.size)
    if not of.is_number:
        return of.base
    scalar = (LANE if varying else PLAIN)[of.base]
    if of.columns:
        return "mat%d<%s>" % (of.rows, scalar)
    return scalar if of.rows == 1 else "vec%d<%s>" % (of.rows, scalar)


def always_varies(of):
    """Structs and arrays of variables are not inferred."""
    return of.size is not None or not of.is_number


class Emitter:
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
        for name, code in (("gl_WorkGroupID", "gl_WorkGroupID"),):
            self.globals[name] = Variable(code, Type("uint", 3), False, None)
        self.globals["gl_LocalInvocationIndex"] = Variable("gl_LocalInvocationIndex", UINT, True, None)

    # --- globals
    def constant(self, node):
        """The number that a constant expression of integers comes to."""
        if isinstance(node, int):
            return node
        if node.kind == "number":
            return int(node.text.rstrip("uU"), 0)
        if node.kind == "name":
            for item in self.parser.items:
                if item.kind == "global" and item.decl.name == node.name and "const" in item.qualifiers:
                    return self.constant(item.decl.value)
        if node.kind == "binary":
            left, right = self.constant(node.left), self.constant(node.right)
            return {"+": left + right, "-": left - right, "*": left * right, "/": left // max(right, 1)}[node.op]
        raise Failure("line %d: no constant" % node.line)

    def settle(self, of):
        """The type with its size as a number."""
        if of.size is None or of.size == -1:
            return of
        return Type(of.base, of.rows, of.columns, self.constant(of.size))

    def add_global(self, item):
        of = self.settle(item.decl.type)
        name = item.decl.name
        self.globals[name] = Variable(name, of, False, None)
        self.globals[name].is_memory = "shared" in item.qualifiers

    def add_block(self, item):
        for name, of in item.members:
            self.globals[name if not item.instance else item.instance + "." + name] = Variable(
                "%s->%s" % (item.instance or item.name, name), self.settle(of), False, None)
            self.globals[name if not item.instance else item.instance + "." + name].is_memory = of.size == -1

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
                known.done = False
            self.emit(main)
        return main

    def emit(self, instance):
        if getattr(instance, "done", False):
            return
        instance.done = True
        while True:
            before = dict(instance.known), instance.returns_varying
            Function(self, instance).emit()
            if before == (instance.known, instance.returns_varying):
                break
            self.changed = True
        self.order.append(instance)


class Function:
    """Writes one instance, by what is known so far; notes what turned out to vary."""

    def __init__(self, whole, instance):
        self.whole, self.instance, self.node = whole, instance, instance.node
        self.lines, self.depth, self.n_names, self.n_regions, self.n_keys = [], 1, 0, 0, 0
        self.scopes, self.loops = [{}], []
        self.may_return = False
        self.parts, self.kept = [], []  # of a main() with barriers: its parts' lines, and what they share

    # --- text
    def line(self, text):
        self.lines.append("    " * self.depth + text)

    def fresh(self, stem):
        self.n_names += 1
        return "%s_%d" % (stem, self.n_names)

    def fail(self, node, what):
        raise Failure("line %d: %s" % (node.line, what))

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

    # --- variables
    def note(self, key, varying):
        """Whether what `key` names varies, by now."""
        varying = varying or self.instance.known.get(key, False)
        self.instance.known[key] = varying
        return varying

    def declare(self, name, of, region=None):
        self.n_keys += 1
        key = "%s %d" % (name, self.n_keys)
        varying = self.note(key, always_varies(of))
        variable = Variable(self.fresh(name), of, varying, region or self.region, key)
        self.scopes[-1][name] = variable
        return variable

    def find(self, node, name):
        for scope in reversed(self.scopes):
            if name in scope:
                return scope[name]
        if name in self.whole.globals:
            return self.whole.globals[name]
        return self.fail(node, "%s is not declared" % name)

    # --- statements
    def compound(self, node):
        self.scopes.append({})
        for statement in node.body:
            self.statement(statement)
        self.scopes.pop()

    def statement(self, node):
        getattr(self, "do_" + node.kind)(node)

    def do_compound(self, node):
        self.line("{")
        self.depth += 1
        self.compound(node)
        self.depth -= 1
        self.line("}")

    def do_declare(self, node):
        for decl in node.decls:
            of = self.whole.settle(decl.type)
            value = self.value(decl.value) if decl.value else None
            if value:
                value = self.converted(value, of)
            variable = self.declare(decl.name, of)
            if value and value.varying and not variable.varying:
                variable.varying = self.note(variable.key, True)
            if value:
                whole = self.lanes(value) if variable.varying else value
                value = Value(self.taken(whole.code), whole.type, whole.varying)
            code = " = " + self.lanes(value).code if value and variable.varying else " = " + value.code if value else ""
            if self.has_barrier and len(self.scopes) == 2:
                self.kept.append("%s %s;" % (cpp_type(of, variable.varying), variable.code))
                variable.code = "kept." + variable.code
                self.line("%s%s;" % (variable.code, code))
            else:
                self.line("%s %s%s;" % (cpp_type(of, variable.varying), variable.code, code))

    def do_expression(self, node):
        self.value(node.value, is_used=False)

    def do_return(self, node):
        value = self.value(node.value) if node.value else None
        if value:
            value = self.converted(value, self.returns)
            if self.region is not self.top or self.may_return or value.varying:
                if not (self.instance.returns_varying or always_varies(self.returns)):
                    # Uniform only where one value leaves in all lanes.
                    if value.varying or self.region is not self.top or self.may_return:
                        self.instance.returns_varying = True
            if self.instance.returns_varying or always_varies(self.returns):
                value = self.lanes(value)
        if self.region is self.top:
            if not value:
                self.line("return;")
            elif self.may_return:
                self.line("return select(m0, %s, result);" % value.code)
            else:
                self.line("return %s;" % self.taken(value.code))
            return
        self.may_return = True
        if value:
            self.line("result = select(%s, %s, result);" % (self.region.mask, value.code))
        self.line("live &= ~%s;" % self.region.mask)
        for loop in self.loops:
            if loop.diverges:
                self.line("%s &= ~%s;" % (loop.alive, self.region.mask))
                if loop.body != self.region.mask:
                    self.line("%s &= ~%s;" % (loop.body, self.region.mask))
        self.line("%s = vbool{};" % self.region.mask)

    def do_break(self, node):
        loop = self.loops[-1]
        if loop.region is self.region and not loop.diverges:
            self.line("break;")
            return
        if not loop.diverges:
            loop.node.diverges = True
            self.whole.changed = True
            self.instance.known["loop %d" % self.n_keys] = True
            return
        self.line("%s &= ~%s;" % (loop.alive, self.region.mask))
        self.leave_body(loop)

    def do_continue(self, node):
        loop = self.loops[-1]
        if loop.region is self.region and not loop.diverges:
            loop.continues = True
            self.line("goto %s;" % loop.label)
            return
        if not loop.diverges:
            loop.node.diverges = True
            self.whole.changed = True
            self.instance.known["loop %d" % self.n_keys] = True
            return
        self.leave_body(loop)

    def leave_body(self, loop):
        if loop.body != self.region.mask:
            self.line("%s &= ~%s;" % (loop.body, self.region.mask))
        self.line("%s = vbool{};" % self.region.mask)

    def rejoin(self, leaves):
        """After a statement that may have taken lanes out of what is around."""
        if not leaves:
            return
        region = self.region
        if region.loop:
            if region.mask != region.loop.body:
                self.line("%s &= %s;" % (region.mask, region.loop.body))
        elif region is not self.top:
            self.line("%s &= live;" % region.mask)
        else:
            self.line("m0 &= live;")
            self.line("if (none(m0))")
            self.line("    return%s;" % (" result" if self.returns != VOID else ""))

    def branch(self, statement, mask):
        """A statement where only the lanes of `mask` are active."""
        self.branch_to(self.statement, statement, mask)

    def branch_to(self, write, node, mask):
        self.n_regions += 1
        name = "m%d" % self.n_regions
        self.line("{")
        self.depth += 1
        self.line("vbool %s = %s & %s;" % (name, self.region.mask, mask))
        self.line("if (some(%s)) {" % name)
        self.depth += 1
        outer = self.region
        self.region = Region(name, outer.loop)
        self.scopes.append({})
        write(node)
        self.scopes.pop()
        self.region = outer
        self.depth -= 1
        self.line("}")
        self.depth -= 1
        self.line("}")

    def do_if(self, node):
        test = self.value(node.test)
        if not test.varying:
            self.line("if (%s) {" % test.code)
            self.inner(node.then)
            if node.other:
                self.line("} else {")
                self.inner(node.other)
            self.line("}")
            self.rejoin(self.leaves(node))
            return
        mask = self.fresh("test")
        self.line("const vbool %s = %s;" % (mask, test.code))
        self.branch(node.then, mask)
        if node.other:
            self.branch(node.other, "~" + mask)
        self.rejoin(self.leaves(node))

    def inner(self, statement):
        self.depth += 1
        self.scopes.append({})
        self.statement(statement)
        self.scopes.pop()
        self.depth -= 1

    def leaves(self, node):
        """Whether a statement may take lanes out of the region around it: not by what ends in its own loop."""
        if self.ends(node, ("return",), True) and (self.may_return):
            return True
        return bool(self.region.loop) and self.ends(node, ("break", "continue"), False)

    def ends(self, node, kinds, through_loops):
        if node is None:
            return False
        if node.kind in kinds:
            return True
        if node.kind == "compound":
            return any(self.ends(part, kinds, through_loops) for part in node.body)
        if node.kind == "if":
            return self.ends(node.then, kinds, through_loops) or self.ends(node.other, kinds, through_loops)
        return node.kind == "loop" and through_loops and self.ends(node.body, kinds, through_loops)

    def do_loop(self, node):
        self.line("{")
        self.depth += 1
        self.scopes.append({})
        # What the head declares is seen by the lanes that go on alone.
        outer = self.region
        head = Region(outer.mask, outer.loop)
        self.region = head
        if node.first:
            self.statement(node.first)
        if node.diverges:
            self.diverging_loop(node, outer, head)
        else:
            self.region = outer
            for scope in self.scopes[-1:]:
                for variable in scope.values():
                    variable.region = outer
            self.uniform_loop(node)
        self.region = outer
        self.scopes.pop()
        self.depth -= 1
        self.line("}")
        self.rejoin(self.leaves(node))

    def uniform_loop(self, node):
        loop = Loop(None, None, False, self.region, self.fresh("next"))
        loop.node = node
        self.line("for (;;) {")
        self.depth += 1
        if node.test:
            test = self.value(node.test)
            if test.varying:
                node.diverges = True
                self.whole.changed = True
                self.instance.known["loop %d %d" % (node.line, self.n_keys)] = True
            self.line("if (!(%s))" % (test.code if not test.varying else "true"))
            self.line("    break;")
        self.loops.append(loop)
        self.line("{")
        self.inner(node.body)
        self.line("}")
        self.loops.pop()
        if loop.continues:
            self.line("%s:;" % loop.label)
        if node.step:
            self.value(node.step, is_used=False)
        self.depth -= 1
        self.line("}")

    def diverging_loop(self, node, outer, head):
        alive, body = self.fresh("alive"), self.fresh("body")
        self.line("vbool %s = %s;" % (alive, outer.mask))
        head.mask = alive
        self.line("for (;;) {")
        self.depth += 1
        if node.test:
            test = self.value(node.test)
            self.line("%s &= %s;" % (alive, self.lanes(test).code))
        self.line("if (none(%s))" % alive)
        self.line("    break;")
        self.line("vbool %s = %s;" % (body, alive))
        loop = Loop(alive, body, True, None, None)
        self.loops.append(loop)
        self.region = Region(body, loop)
        loop.region = self.region
        self.inner(node.body)
        self.region = head
        self.loops.pop()
        if node.step:
            self.value(node.step, is_used=False)
        self.depth -= 1
        self.line("}")

    # --- values
    def value(self, node, is_used=True):
        if node.kind in ("assign", "step", "call"):
            return getattr(self, "of_" + node.kind)(node, is_used)
        return getattr(self, "of_" + node.kind)(node)

    def lanes(self, value):
        """The value in every lane."""
        if value.varying:
            return value
        return Value("lanes(%s)" % value.code, value.type, True)

    def converted(self, value, of):
        """By GLSL's implicit conversions."""
        if value.type == of or not of.is_number or of.size is not None:
            return value
        if value.type.base == of.base:
            return value
        to = Type(of.base, value.type.rows, value.type.columns)
        return Value("%sto_%s(%s)" % (self.from_bool(value), of.base, value.code), to, value.varying)

    @staticmethod
    def from_bool(value):
        return "bool_" if value.type.base == "bool" else ""

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

    def of_number(self, node):
        text = node.text
        if text[-1] in "uU":
            return Value(text, UINT, False)
        if text.startswith("0x") or text.isdigit():
            return Value(text, INT, False)
        return Value(text + "f", FLOAT, False)

    def of_bool(self, node):
        return Value(node.text, BOOL, False)

    def of_name(self, node):
        variable = self.find(node, node.name)
        varying = (variable.varying or variable.type.base in self.whole.structs or
                   (variable.region is not None and always_varies(variable.type)))
        return Value(variable.code, variable.type, varying, variable)

    def of_member(self, node):
        if node.of.kind == "name" and node.of.name + "." + node.name in self.whole.globals:
            variable = self.whole.globals[node.of.name + "." + node.name]
            return Value(variable.code, variable.type, False, variable)
        of = self.value(node.of)
        if of.type.size is None and of.type.base in self.whole.structs:
            for name, kind in self.whole.structs[of.type.base]:
                if name == node.name:
                    return Value("%s.%s" % (of.code, name), self.whole.settle(kind), True, of.variable)
            self.fail(node, "no member %s" % node.name)
        return self.swizzle(node, of)

    def swizzle(self, node, of):
        names = "xyzw" if node.name[0] in "xyzw" else "rgba" if node.name[0] in "rgba" else "stpq"
        parts = [names.index(letter) for letter in node.name]
        if of.type.rows == 1:
            self.fail(node, "a scalar has no .%s" % node.name)
        if len(parts) == 1:
            return Value("%s.%s" % (of.code, "xyzw"[parts[0]]), Type(of.type.base), of.varying, of.variable)
        value = Value("swizzle<%s>(%s)" % (", ".join(map(str, parts)), of.code), Type(of.type.base, len(parts)),
                      of.varying)
        value.swizzled = (of, parts)
        return value

    def of_index(self, node):
        of, at = self.value(node.of), self.value(node.at)
        kind = of.type.element()
        if of.type.base in TEXEL:  # an array of textures, of one
            return Value(of.code, kind, False, of.variable)
        if of.variable and of.variable.is_memory:
            place = self.lanes(self.converted(at, INT)).code
            value = Value("load_at(%s, %s)" % (of.code, place), kind, True)
            value.memory = (of.code, place)
            return value
        if of.variable and not of.variable.region and of.type.size and not of.varying and at.varying:
            return Value("gather_at(%s, %s)" % (of.code, at.code), kind, True)
        if not at.varying:
            return Value("%s[%s]" % (of.code, at.code), kind, of.varying, of.variable)
        value = Value("pick(%s, %s)" % (self.lanes(of).code, at.code), kind, True, of.variable)
        value.picked = (of, at)
        return value

    def of_unary(self, node):
        of = self.value(node.of)
        if node.op == "!":
            return Value(("~(%s)" if of.varying else "!(%s)") % of.code, of.type, of.varying)
        return Value("(%s%s)" % (node.op, of.code), of.type, of.varying)

    def calls(self, node):
        """Whether an expression calls one of the program's functions."""
        if not isinstance(node, Node):
            return isinstance(node, list) and any(self.calls(part) for part in node)
        if node.kind == "call" and (node.name in self.whole.functions or node.name in MEMORY):
            return True
        return any(self.calls(part) for part in node.__dict__.values())

    def under(self, mask, result, node, of):
        """Puts an operand's value into `result`, in the lanes of `mask`."""
        def store(_):
            value = self.lanes(self.converted(self.value(node), of))
            self.line("%s = select(%s, %s, %s);" % (result, self.region.mask, value.code, result))
        self.branch_to(store, node, mask)

    def short_circuit(self, node):
        """&& and || whose second operand must not run, or need not, where the first tells the result."""
        left = self.value(node.left)
        if not left.varying:
            left = self.lanes(left)
        result = self.fresh("t")
        self.line("vbool %s = %s;" % (result, left.code))
        self.under(result if node.op == "&&" else "~" + result, result, node.right, BOOL)
        return Value(result, BOOL, True)

    def of_binary(self, node):
        if node.op in ("&&", "||") and self.calls(node.right):
            return self.short_circuit(node)
        left, right, op = self.value(node.left), self.value(node.right), node.op
        if op in ("<<", ">>"):
            right = self.converted(right, Type(left.type.base))
        elif left.type.base != right.type.base:
            wide = self.wider(left.type.base, right.type.base)
            left, right = self.converted(left, Type(wide)), self.converted(right, Type(wide))
        varying = left.varying or right.varying
        if varying:
            left, right = self.lanes(left), self.lanes(right)
        if op in ("&&", "||"):
            op = op if not varying else op[0]
            return Value("(%s %s %s)" % (left.code, op, right.code), BOOL, varying)
        if op in ("==", "!="):
            code = "equal(%s, %s)" % (left.code, right.code)
            return Value(code if op == "==" else ("~" if varying else "!") + code, BOOL, varying)
        if op in ("<", ">", "<=", ">="):
            return Value("(%s %s %s)" % (left.code, op, right.code), BOOL, varying)
        return self.combined(left, op, right, varying)

    def combined(self, left, op, right, varying):
        """An arithmetic operation of what has one base and varies alike."""
        of = self.product_type(left.type, right.type, op)
        if op in "/%" and varying and left.type.base in ("int", "uint"):
            # Lanes that are not active may divide by anything, and processors trap where that is 0.
            return Value("%s(%s, %s)" % ("quotient" if op == "/" else "remainder", left.code, right.code), of, True)
        return Value("(%s %s %s)" % (left.code, op, right.code), of, varying)

    @staticmethod
    def wider(a, b):
        for base in ("double", "float", "uint", "int"):
            if base in (a, b):
                return base
        return a

    @staticmethod
    def product_type(left, right, op):
        if op == "*" and left.columns and right.rows > 1 and not right.columns:
            return Type("float", left.rows)
        if op == "*" and right.columns and left.rows > 1 and not left.columns:
            return Type("float", right.columns)
        if left.columns or left.rows > right.rows:
            return left
        return right if right.columns or right.rows > 1 else left

    def chosen(self, node, test):
        """?: whose operands run in their own lanes."""
        result, at = self.fresh("t"), len(self.lines)
        mask = self.fresh("test")
        self.line("const vbool %s = %s;" % (mask, self.lanes(test).code))
        kinds = []
        for operand, where in ((node.yes, mask), (node.no, "~" + mask)):
            def store(operand=operand):
                value = self.lanes(self.value(operand))
                kinds.append(value.type)
                self.line("%s = select(%s, %s, %s);" % (result, self.region.mask, value.code, result))
            self.branch_to(lambda _, store=store: store(), operand, where)
        if kinds[0] != kinds[1]:
            self.fail(node, "operands of ?: that call functions are of one type")
        self.lines.insert(at, "    " * self.depth + "%s %s = {};" % (cpp_type(kinds[0], True), result))
        return Value(result, kinds[0], True)

    def of_ternary(self, node):
        if self.calls(node.yes) or self.calls(node.no):
            test = self.value(node.test)
            if test.varying:
                return self.chosen(node, test)
        test, yes, no = self.value(node.test), self.value(node.yes), self.value(node.no)
        if yes.type.base != no.type.base and yes.type.is_number:
            wide = self.wider(yes.type.base, no.type.base)
            yes, no = self.converted(yes, Type(wide)), self.converted(no, Type(wide))
        varying = test.varying or yes.varying or no.varying
        if varying:
            yes, no = self.lanes(yes), self.lanes(no)
        if not test.varying:
            return Value("(%s ? %s : %s)" % (test.code, yes.code, no.code), yes.type, varying)
        return Value("select(%s, %s, %s)" % (test.code, yes.code, no.code), yes.type, True)

    def of_construct(self, node):
        of = self.whole.settle(node.type)
        given = [self.value(argument) for argument in node.arguments]
        if of.size is not None:
            of = Type(of.base, of.rows, of.columns, len(given) if of.size == -1 else of.size)
            given = [self.lanes(value) for value in given]
            return Value("%s{{%s}}" % (cpp_type(of, True), ", ".join(v.code for v in given)), of, True)
        if of.base in self.whole.structs:
            members = self.whole.structs[of.base]
            given = [self.lanes(self.converted(v, self.whole.settle(kind))) for v, (_, kind) in zip(given, members)]
            return Value("%s{%s}" % (of.base, ", ".join(v.code for v in given)), of, True)
        varying = any(value.varying for value in given)
        given = [Value("%sto_%s(%s)" % (self.from_bool(v), of.base, v.code), v.type, v.varying) if v.type.base != of.base else v
                 for v in given]
        if varying:
            given = [self.lanes(value) for value in given]
        if of.is_scalar:
            return Value(given[0].code if given[0].type.rows == 1 else given[0].code + ".x", of, varying)
        return Value("%s(%s)" % (cpp_type(of, varying), ", ".join(v.code for v in given)), of, varying)

    # --- calls
    def of_call(self, node, is_used):
        if node.name in self.whole.functions:
            return self.user_call(node)
        if node.name in MEMORY:
            return self.memory_call(node)
        if node.name not in BUILTINS:
            self.fail(node, "no function %s" % node.name)
        given = [self.value(argument) for argument in node.arguments]
        how = BUILTINS[node.name]
        if how in ("same", "scalar", "bools") and node.name != "ldexp":
            base = given[0].type.base
            for value in given[1:]:
                if value.type.base != "bool":
                    base = self.wider(base, value.type.base)
            given = [self.converted(v, Type(base)) if v.type.base != "bool" else v for v in given]
        varying = any(value.varying for value in given)
        if varying:
            given = [self.lanes(value) for value in given]
        widest = max((v.type for v in given), key=lambda t: t.rows)
        widest = Type(given[0].type.base, widest.rows, widest.columns)
        of = {"same": widest, "scalar": Type(widest.base), "bools": Type("bool", widest.rows),
              "uints": Type("uint", widest.rows), "floats": Type("float", widest.rows)}.get(how, how)
        return Value("%s(%s)" % (node.name, ", ".join(v.code for v in given)), of, varying)

    def fits(self, function, given):
        """How well arguments fit: None where they do not, else how many need a conversion."""
        if len(function.params) != len(given):
            return None
        cost = 0
        for param, value in zip(function.params, given):
            of = self.whole.settle(param.type)
            if of != value.type:
                if not (of.is_scalar and value.type.is_scalar and of.base in ("float", "uint")):
                    return None
                cost += 1
        return cost

    def user_call(self, node):
        given = [self.value(argument) for argument in node.arguments]
        fitting = [(self.fits(f, given), i) for i, f in enumerate(self.whole.functions[node.name])]
        fitting = [pair for pair in fitting if pair[0] is not None]
        if not fitting:
            self.fail(node, "no %s takes these arguments: %s" % (node.name, [v.type for v in given]))
        function = self.whole.functions[node.name][min(fitting)[1]]
        given = [self.converted(v, self.whole.settle(p.type)) for v, p in zip(given, function.params)]
        varying = tuple(v.varying or always_varies(v.type) or p.way != "in" for v, p in zip(given, function.params))
        callee = self.whole.instance(function, varying)
        self.whole.emit(callee)
        codes, after = [self.region.mask], []
        for value, param, argument in zip(given, function.params, node.arguments):
            of = self.whole.settle(param.type)
            if param.way == "in":
                varies = callee.known.get("param " + param.name, False)
                codes.append(self.lanes(value).code if varies else value.code)
                continue
            variable = self.find(argument, argument.name) if argument.kind == "name" else None
            if variable and variable.region is self.region and variable.varying and not variable.is_out:
                if variable.key.startswith("param "):
                    self.note("changed" + variable.key[5:], True)
                codes.append(variable.code)
                continue
            temporary = self.fresh("out")
            self.line("%s %s = %s;" % (cpp_type(of, True), temporary, self.lanes(value).code))
            codes.append(temporary)
            after.append((argument, Value(temporary, of, True)))
        returns = self.whole.settle(function.type)
        call = "%s(%s)" % (callee.name, ", ".join(codes))
        if returns == VOID:
            self.line(call + ";")
            result = Value("", VOID, False)
        else:
            result = self.stored(Value(call, returns, callee.returns_varying or always_varies(returns)))
        for argument, value in after:
            self.assign(argument, value)
        return result

    def barrier(self, node):
        """Ends this part of main(); the next part begins when all of the workgroup are here. What main() has
        declared until then is kept."""
        if self.region is not self.top or len(self.scopes) > 2 or self.may_return:
            self.fail(node, "a barrier stands in main() itself, before any return")
        self.parts.append(self.lines)
        self.lines = []

    def memory_call(self, node):
        name, mask = node.name, self.region.mask
        if name == "barrier":
            self.barrier(node)
            return Value("", VOID, False)
        if name == "frexp":
            whole = self.fresh("out")
            of = self.value(node.arguments[0])
            self.line("vint %s;" % whole)
            result = self.stored(Value("frexp(%s, %s)" % (self.lanes(of).code, whole), of.type, True))
            self.assign(node.arguments[1], Value(whole, INT, True))
            return result
        first = node.arguments[0]
        if name.startswith("atomic"):
            place, more = self.value(first), self.value(node.arguments[1])
            more = self.converted(more, place.type)
            if hasattr(place, "memory"):
                self.fail(node, "no atomic operation on an array")
            return self.stored(Value("%s(%s, %s, %s)" % (name, place.code, self.lanes(more).code, mask), UINT, True))
        image = self.value(first)
        given = [self.value(argument) for argument in node.arguments[1:]]
        if name == "makeTexels":
            node, part = (self.lanes(value).code for value in given)
            return self.stored(Value("makeTexels(%s, %s, %s, %s)" % (image.code, node, part, mask), UINT, True))
        if name == "textureSize":
            return Value("textureSize(%s, 0)" % image.code, Type("int", 2), False)
        if name == "imageStore":
            at, of = self.lanes(given[0]), self.lanes(given[1])
            self.line("imageStore(%s, %s, %s, %s);" % (image.code, at.code, of.code, mask))
            return Value("", VOID, False)
        codes = [self.lanes(value).code for value in given[:2 if name == "textureLod" else 1]]
        return self.stored(Value("%s(%s, %s)" % (name, image.code, ", ".join(codes)), TEXEL[image.type.base], True))

    # --- assignments
    def of_assign(self, node, is_used):
        right = self.value(node.right)
        if node.op:
            left = self.value(node.left)
            right = self.of_binary_of(node, left, right)
        self.assign(node.left, right)
        return self.value(node.left) if is_used else None

    def of_binary_of(self, node, left, right):
        op = node.op
        if op in ("<<", ">>"):
            right = self.converted(right, Type(left.type.base))
        else:
            right = self.converted(right, left.type)
        varying = left.varying or right.varying
        if varying:
            left, right = self.lanes(left), self.lanes(right)
        return self.combined(left, op, right, varying)

    def of_step(self, node, is_used):
        left = self.value(node.of)
        old = self.stored(left) if is_used and node.is_post else None
        one = Value("1", INT, False)
        self.assign(node.of, self.of_binary_of(Node("assign", node.line, op=node.op[0]), left, one))
        return old if old else self.value(node.of) if is_used else None

    def root(self, node):
        while node.kind in ("member", "index"):
            node = node.of
        if node.kind != "name":
            self.fail(node, "cannot be assigned")
        return node

    def assign(self, target, right):
        """Stores a value where `target` says, in the lanes that are active."""
        root = self.root(target)
        if not any(root.name in scope for scope in self.scopes):
            self.assign_global(target, right)
            return
        variable = self.find(root, root.name)
        if variable.key and variable.key.startswith("param "):
            self.note("changed" + variable.key[5:], True)
        whole = variable.region is self.region
        left = self.value(target)
        if not variable.varying and (right.varying or not whole or left.varying):
            variable.varying = self.note(variable.key, True)
        right = self.converted(right, left.type)
        if variable.varying:
            right = self.lanes(right)
        # A caller reads what lanes had put into its argument before they returned.
        kept = variable.is_out and self.may_return
        mask = None if whole and not kept else self.region.mask
        if hasattr(left, "swizzled"):
            of, parts = left.swizzled
            right = self.stored(right)
            for i, part in enumerate(parts):
                self.put("%s.%s" % (of.code, "xyzw"[part]), "%s.%s" % (right.code, "xyzw"[i]), mask)
        elif hasattr(left, "picked"):
            of, at = left.picked
            self.line("put_at(%s, %s, %s, %s);" % (of.code, at.code, right.code, self.region.mask))
        else:
            self.put(left.code, right.code, mask)

    def put(self, left, right, mask):
        if mask:
            self.line("%s = select(%s, %s, %s);" % (left, mask, right, left))
        else:
            self.line("%s = %s;" % (left, self.taken(right)))

    def assign_global(self, target, right):
        left = self.value(target)
        if not hasattr(left, "memory"):
            self.fail(target, "this global cannot be assigned")
        code, place = left.memory
        right = self.lanes(self.converted(right, left.type))
        self.line("store_at(%s, %s, %s, %s);" % (code, place, right.code, self.region.mask))
