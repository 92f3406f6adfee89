"""Which variables a function has, and which of them vary from lane to lane."""
from .cpp import TEXEL, always_varies
from .writer import Writer


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
    """node: of the tree. diverges: lanes leave it one by one: alive and body are the masks of those that are in it and
    of those that are in this turn. label: where `continue` jumps to in one that does not diverge."""

    def __init__(self, node, region, label=None, alive=None, body=None):
        self.node, self.region, self.label, self.alive, self.body = node, region, label, alive, body
        self.diverges, self.continues = alive is not None, False


class Scope(Writer):
    """Names and what they stand for. `region` is the one that is written now."""

    def __init__(self, whole, instance):
        super().__init__()
        self.whole, self.instance, self.node = whole, instance, instance.node
        self.n_keys, self.scopes, self.region, self.top = 0, [{}], None, None

    def note(self, key, varying):
        """Whether what `key` names varies, by now."""
        varying = varying or self.instance.known.get(key, False)
        self.instance.known[key] = varying
        return varying

    def declare(self, node, of):
        """A variable of the region that is written."""
        if of.base in TEXEL:
            self.fail(node, "images and textures are global")
        name = node.name
        self.n_keys += 1
        key = "%s %d" % (name, self.n_keys)
        varying = self.note(key, always_varies(of))
        variable = Variable(self.fresh(name), of, varying, self.region, key)
        self.scopes[-1][name] = variable
        return variable

    def find(self, node, name):
        for scope in reversed(self.scopes):
            if name in scope:
                return scope[name]
        if name in self.whole.globals:
            return self.whole.globals[name]
        return self.fail(node, "%s is not declared" % name)
