"""Statements and control flow. A kind of node of parse.py is written by the method do_KIND."""
from .assignments import Assignments
from .cpp import always_varies, cpp_type
from .scope import Loop, Region
from .writer import Value


class Statements(Assignments):
    """What is uniform becomes C++'s own control flow; what varies runs under masks (regions.py)."""

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
            variable = self.declare(decl, of)
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
        loop = Loop(node, self.region, self.fresh("next"))
        self.line("for (;;) {")
        self.depth += 1
        if node.test:
            test = self.value(node.test)
            if test.varying:
                node.diverges = True
                self.whole.changed = True
                self.instance.known["loop %s %d" % (node.place, self.n_keys)] = True
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
        loop = Loop(node, None, alive=alive, body=body)
        self.loops.append(loop)
        self.region = loop.region = Region(body, loop)
        self.inner(node.body)
        self.region = head
        self.loops.pop()
        if node.step:
            self.value(node.step, is_used=False)
        self.depth -= 1
        self.line("}")
