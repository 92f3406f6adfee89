"""Parts of a function in which the same lanes are active, and the masks that say which."""
from .cpp import VOID
from .scope import Region, Scope


class Regions(Scope):
    """Opens regions, and takes lanes out of the masks around."""

    def __init__(self, whole, instance):
        super().__init__(whole, instance)
        self.n_regions, self.loops = 0, []
        self.may_return = False  # in some lanes, before the end

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
