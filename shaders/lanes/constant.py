"""python3 -m lanes.constant FILE NAME: writes the constant NAME of a shader file, an array of float vectors, to standard
output as the rows of a C array's initialiser. By it C code has the same numbers as the shaders: the Makefile makes
edge_rays.inc for server/render/native/rays/ask.c."""
import sys

from .parse import Failure, Parser


def number(node):
    """A literal, as C writes a float."""
    if node.kind == "unary" and node.op == "-":
        return "-" + number(node.of)
    if node.kind != "number" or "." not in node.text:
        raise Failure("%s: a number with a point is wanted" % node.place)
    return node.text + "f"


def rows(text, name):
    """[[components of a vector] of the array]."""
    for item in Parser(text).items:
        if item.kind == "global" and item.decl.name == name and "const" in item.qualifiers:
            value = item.decl.value
            if value.kind != "construct" or value.type.size is None or value.type.base != "float":
                raise Failure("%s: %s is no array of float vectors" % (value.place, name))
            return [[number(part) for part in vector.arguments] for vector in value.arguments]
    raise Failure("there is no constant %s" % name)


def main():
    path, name = sys.argv[1:]
    with open(path, encoding="utf-8") as file:
        text = file.read()
    try:
        for vector in rows(text, name):
            print("{%s}," % ", ".join(vector))
    except Failure as failure:
        sys.exit("%s: %s" % (path, failure))


if __name__ == "__main__":
    main()
