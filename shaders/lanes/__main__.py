"""python3 -m lanes NAME: writes a program of `shaders/programs` to standard output, as C++ for
server/render/native/programs/glsl.hpp: what is compiled as native_NAME_SET for each instruction set."""
import os
import re
import subprocess
import sys

from listed import listed_programs

from .parse import Failure
from .program import program_text

HERE = os.path.dirname(os.path.abspath(__file__))
# Tables fill one bank each, and sub-patches are made where they are wanted; which lines, light and pattern there are is
# known when a program runs.
MACROS = ("MADE_PATCHES POINT_BANKS=1 NODE_BANKS=1 ADJACENCY_BANKS=1 BANK_TEXELS=1 NODE_BANK_TEXELS=1 TEXTURES_FREE=3 "
          "PTEX FAMILY=line_family LIGHT=light_kind PATTERN=pattern_kind IS_SOFT=is_soft IS_FILTERED=is_filtered").split()
KINDS = "uniform int line_family, light_kind, pattern_kind;\nuniform bool is_soft, is_filtered;\n"


def path_of(file_name):
    """What no graphics card runs stands here."""
    own = os.path.join(HERE, file_name)
    return own if os.path.exists(own) else os.path.join(HERE, "..", file_name)


def main():
    name = sys.argv[1]
    text = ""
    for file_name in listed_programs("native")[name][0]:
        with open(path_of(file_name + ".glsl"), encoding="utf-8") as file:
            text += '#line 1 "%s.glsl"\n' % file_name + file.read()
    text = subprocess.run(os.environ.get("CC", "cc").split() + ["-E", "-undef", "-nostdinc", "-xc"] +
                          ["-D" + macro for macro in MACROS] + ["-"],
                          input=text, capture_output=True, text=True, check=True).stdout
    if re.search(r"\b(line_family|light_kind|pattern_kind|is_soft|is_filtered)\b", text):
        text = KINDS + text
    try:
        sys.stdout.write('#include "server/render/native/programs/glsl.hpp"\n\n' + program_text(text, name))
    except Failure as failure:
        sys.exit("%s: %s" % (name, failure))


main()
