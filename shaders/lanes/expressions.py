"""What an expression's value is in C++. A kind of node of parse.py is written by the method of_KIND."""
from .cpp import BOOL, FLOAT, INT, MEMORY, TEXEL, UINT, always_varies, cpp_type
from .parse import Node, Type
from .regions import Regions
from .writer import Value


class Expressions(Regions):
    """All but calls (calls.py) and assignments (assignments.py)."""

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
        parts = [names.find(letter) for letter in node.name]
        if of.type.rows == 1 or of.type.size is not None or min(parts) < 0 or max(parts) >= of.type.rows:
            self.fail(node, "no .%s of this" % node.name)
        if len(parts) == 1:
            return Value("%s.%s" % (of.code, "xyzw"[parts[0]]), Type(of.type.base), of.varying, of.variable)
        return Value("swizzle<%s>(%s)" % (", ".join(map(str, parts)), of.code), Type(of.type.base, len(parts)),
                     of.varying, swizzled=(of, parts))

    def of_index(self, node):
        of, at = self.value(node.of), self.value(node.at)
        if of.type.is_scalar or (of.type.size is None and of.type.base in self.whole.structs):
            self.fail(node, "no element of this")
        kind = of.type.element()
        if of.type.base in TEXEL:  # an array of textures, of one
            return Value(of.code, kind, False, of.variable)
        if of.variable and of.variable.is_memory:
            place = self.lanes(self.converted(at, INT)).code
            return Value("load_at(%s, %s)" % (of.code, place), kind, True, memory=(of.code, place))
        if of.variable and not of.variable.region and of.type.size and not of.varying and at.varying:
            return Value("gather_at(%s, %s)" % (of.code, at.code), kind, True)
        if not at.varying:
            return Value("%s[%s]" % (of.code, at.code), kind, of.varying, of.variable)
        return Value("pick(%s, %s)" % (self.lanes(of).code, at.code), kind, True, of.variable, picked=(of, at))

    def of_unary(self, node):
        of = self.value(node.of)
        if node.op == "!":
            return Value(("~(%s)" if of.varying else "!(%s)") % of.code, of.type, of.varying)
        return Value("(%s%s)" % (node.op, of.code), of.type, of.varying)

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
