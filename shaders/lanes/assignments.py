"""Assignments, which change the active lanes alone."""
from .calls import Calls
from .cpp import INT
from .parse import Node, Type
from .writer import Value


class Assignments(Calls):
    """To variables, their members and elements, and to open arrays in memory."""

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
        self.assign(node.of, self.of_binary_of(Node("assign", node.place, op=node.op[0]), left, one))
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
        if left.swizzled:
            of, parts = left.swizzled
            right = self.stored(right)
            for i, part in enumerate(parts):
                self.put("%s.%s" % (of.code, "xyzw"[part]), "%s.%s" % (right.code, "xyzw"[i]), mask)
        elif left.picked:
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
        if not left.memory:
            self.fail(target, "this global cannot be assigned")
        code, place = left.memory
        right = self.lanes(self.converted(right, left.type))
        self.line("store_at(%s, %s, %s, %s);" % (code, place, right.code, self.region.mask))
