#!/bin/sh
# Writes the shader files given as C source: one table of {name, text}, found by shader_text().
# No escapes are needed beyond \ and ": a line of GLSL becomes a string literal with a newline.
set -eu
echo '#include "server/render/gl/programs/shaders.h"'
echo '#include <stddef.h>'
echo 'const struct shader_file shader_files[] = {'
for f in "$@"; do
    printf '    {"%s",\n' "$(basename "$f")"
    sed -e 's/\\/\\\\/g' -e 's/"/\\"/g' -e 's/^/     "/' -e 's/$/\\n"/' "$f"
    echo '    },'
done
echo '    {NULL, NULL},'
echo '};'
