"""A whole program as a C++ struct: its structs, what its host must set, and its functions."""
import re

from .cpp import PLAIN, cpp_type
from .emit import Emitter, Function, Instance
from .parse import Node, Parser

IMAGES = {"image2D": "image2D<vfloat>", "uimage2D": "image2D<vuint>", "sampler2D": "image2D<vfloat>",
          "usampler2D": "image2D<vuint>", "samplerBuffer": "buffer_texture<vfloat>",
          "usamplerBuffer": "buffer_texture<vuint>"}


def struct_text(whole, name, members):
    """With select() and visit() of it."""
    fields = [(field, whole.settle(of)) for field, of in members]
    lines = ["struct %s {" % name] + ["    %s %s;" % (cpp_type(of, True), field) for field, of in fields] + ["};"]
    chosen = ", ".join("select(m, a.%s, b.%s)" % (field, field) for field, _ in fields)
    lines += ["INLINE %s select(vbool m, const %s &a, const %s &b)" % (name, name, name),
              "{", "    return {%s};" % chosen, "}",
              "template <class F> INLINE void visit(%s &a, F &&f)" % name, "{"]
    lines += ["    visit(a.%s, f);" % field for field, _ in fields] + ["}", ""]
    return lines


def block_text(whole, item):
    """Uniform: as std140 lays it out. A buffer: its open array apart."""
    lines = ["struct %s_block {" % item.name]
    for field, of in item.members:
        of = whole.settle(of)
        if of.size == -1:
            lines.append("    memory<%s> %s;" % (cpp_type(of.element(), True), field))
        elif of.size is not None:
            lines.append("    %s %s[%d];" % (cpp_type(of.element(), False), field, of.size))
        else:
            lines.append("    %s %s;" % ("uint32_t" if of.base == "bool" else cpp_type(of, False), field))
    return lines + ["};", ""]


def constant_text(whole, decl):
    """Of a global constant: one that is a number for the compiler, any other as a member."""
    of = whole.settle(decl.type)
    dummy = Function(whole, Instance(Node("function", decl.place, params=[], name=decl.name), (), decl.name))
    dummy.region = dummy.top = None
    if of.size is not None:
        values = [dummy.converted(dummy.value(a), of.element()).code for a in decl.value.arguments]
        size = len(values) if of.size == -1 else of.size
        whole.globals[decl.name].type = of.array(size)
        return "    const %s %s[%d] = {%s};" % (cpp_type(of.element(), False), decl.name, size, ", ".join(values))
    value = dummy.converted(dummy.value(decl.value), of)
    if of.is_scalar:
        return "    static constexpr %s %s = %s;" % (PLAIN[of.base], decl.name, value.code)
    return "    const %s %s = %s;" % (cpp_type(of, value.varying), decl.name, value.code)


def variable_text(whole, item):
    """Of what the host sets."""
    of, name = whole.settle(item.decl.type), item.decl.name
    if "shared" in item.qualifiers:
        element = cpp_type(of.element(), True)
        return "    memory<%s> %s;\n    uint32_t %s_words[%d * sizeof(%s) / (4 * LANES)];" % (
            element, name, name, of.size, element)
    if name in whole.filtered:
        return "    picture2D %s;" % name
    if name in whole.made:
        return "    made_texture %s;" % name
    if of.base in IMAGES:
        return "    %s %s;" % ("bytes2D" if "rgba8" in item.qualifiers else IMAGES[of.base], name)
    return "    %s %s;" % (cpp_type(of, False), name)


def bind_text(items):
    """Sets what the host binds, by its name."""
    lines = ["    void take(const native_bindings &b)", "    {"]
    for item in items:
        if item.kind == "block":
            name = item.instance or item.name
            lines.append("        %s = (decltype(%s))b.%s;" % (name, name, name))
        elif item.kind == "global" and not {"const", "shared"} & item.qualifiers:
            name = item.decl.name
            lines.append("        set(%s, b.%s);" % (name, name))
        elif item.kind == "global" and "shared" in item.qualifiers:
            name = item.decl.name
            lines.append("        share(%s, %s_words);" % (name, name))
    return lines + ["    }"]


def invoke_text(main, local_size):
    """What dispatch() of glsl.hpp calls: a part of main() for one vector of a workgroup's invocations."""
    lines = ["    enum { LOCAL_SIZE = %d, N_PARTS = %d };" % (local_size, len(main.headers))]
    if main.kept:  # from part to part
        lines += ["    struct kept_by_main {"] + ["        " + text for text in main.kept]
        lines += ["    } kept[(LOCAL_SIZE + LANES - 1) / LANES];"]
    calls = [header[header.index(" ") + 1:header.index("(")] for header in main.headers]
    lines += ["    void invoke(int part, int vector, vbool m)", "    {", "        (void)part, (void)vector;"]
    for i, call in enumerate(calls):
        lines.append("        %s%s(m%s);" % ("" if len(calls) == 1 else "if (part == %d) " % i, call,
                                             ", kept[vector]" if main.kept else ""))
    return lines + ["    }"]


def program_text(text, name):
    whole = Emitter(Parser(text))
    whole.filtered = set(re.findall(r"textureLod\((\w+)", text))
    whole.made = set(re.findall(r"makeTexels\((\w+)", text))
    lines, members = ["namespace", "{", ""], []
    for item in whole.parser.items:
        if item.kind == "struct":
            lines += struct_text(whole, item.name, item.members)
        elif item.kind == "block":
            lines += block_text(whole, item)
            members.append("    %s%s_block *%s;" % ("" if item.is_buffer else "const ", item.name,
                                                    item.instance or item.name))
        elif item.kind == "global" and "const" in item.qualifiers:
            members.append(constant_text(whole, item.decl))
        elif item.kind == "global":
            members.append(variable_text(whole, item))
    main = whole.program()
    members += bind_text(whole.parser.items)
    members += invoke_text(main, whole.constant(whole.parser.local_size))
    lines += ["struct %s_program {" % name, "    vec3<uint32_t> gl_WorkGroupID;", "    vuint gl_LocalInvocationIndex;"]
    lines += members + ["    %s;" % header for instance in whole.order for header in instance.headers] + ["};", ""]
    for instance in whole.order:
        text = instance.text
        for header in instance.headers:
            called = header[:header.index("(")].split(" ")[-1]
            text = text.replace(header, header.replace(called + "(", name + "_program::" + called + "(", 1), 1)
        lines.append(text)
    lines += ["}", "", 'extern "C" native_program SYMBOL(%s);' % name,
              'extern "C" void SYMBOL(%s)(const native_bindings *bindings, uint32_t first, uint32_t end)' % name, "{",
              "    run<%s_program>(*bindings, first, end);" % name, "}", ""]
    return "\n".join(lines)
