"""Calls: of the program's functions, of GLSL's, and of those that touch memory."""
from .cpp import BUILTINS, INT, MEMORY, TEXEL, UINT, VOID, always_varies, cpp_type
from .expressions import Expressions
from .parse import Type
from .writer import Value


class Calls(Expressions):
    """Memory is written, and atomic operations are done, by the active lanes alone."""

    def __init__(self, whole, instance):
        super().__init__(whole, instance)
        self.parts, self.kept = [], []  # of a main() with barriers: its parts' lines, and what they share

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
        if callee.is_open:
            self.fail(node, "%s calls itself" % node.name)
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
        if self.node.name != "main" or self.region is not self.top or len(self.scopes) > 2 or self.may_return:
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
            if place.memory or not place.variable or place.variable.region:
                self.fail(node, "an atomic operation is on a number of a block")
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
