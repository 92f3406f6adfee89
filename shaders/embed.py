"""embed.py FILE...: writes the shader files given, and the graphics card's programs of the list `programs`, as C source
for server/render/gl/programs/shaders.h."""
import os
import sys

from listed import listed_programs


def literal(line):
    return '"%s\\n"' % line.replace("\\", "\\\\").replace('"', '\\"')


def file_text(path):
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    return ['    {"%s",' % os.path.basename(path)] + ["     " + literal(line) for line in lines] + ["    },"]


def names_of(program, k):
    return "%s_files_%d" % (program, k)


def main():
    programs = listed_programs("gl")
    print('#include "server/render/gl/programs/shaders.h"\n#include <stddef.h>')
    print("const struct shader_file shader_files[] = {")
    for path in sys.argv[1:]:
        print("\n".join(file_text(path)))
    print("    {NULL, NULL},\n};")
    for program, shaders in programs.items():
        for k, names in enumerate(shaders):
            print("static const char *const %s[] = {%s, NULL};" %
                  (names_of(program, k), ", ".join('"%s.glsl"' % name for name in names)))
    print("const struct shader_program shader_programs[] = {")
    for program, shaders in programs.items():
        lists = [names_of(program, k) if k < len(shaders) else "NULL" for k in range(2)]
        print('    {"%s", {%s}},' % (program, ", ".join(lists)))
    print("    {NULL, {NULL, NULL}},\n};")


main()
