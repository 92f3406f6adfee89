#!/bin/sh
# Checks format, static analysis, and the rules about includes (CONTRIBUTING.md).
set -u
failed=0
fail() {
    echo "lint: $*"
    failed=1
}

# Reports files of these folders that contain the pattern, except in the files or folders where it belongs.
only_in() { # pattern, what it is, folders to search, then files or folders where it belongs
    pattern=$1 what=$2 folders=$3
    shift 3
    # shellcheck disable=SC2086 # a list of folders
    found=$(grep -rnE --include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp' \
        "$pattern" $folders)
    for allowed in "$@"; do
        found=$(printf '%s\n' "$found" | grep -v "^$allowed")
    done
    found=$(printf '%s' "$found" | sed '/^$/d')
    [ -z "$found" ] || fail "$what outside of $*:
$found"
}

files=$(git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp' '*.hpp' 2>/dev/null ||
    find server client protocol tests -name '*.[ch]' -o -name '*.cpp' -o -name '*.hpp')
# shellcheck disable=SC2086
clang-format --dry-run -Werror $files 2>&1 | grep -m 20 'error:' && fail "run make format"

marked=$(git grep -nE '^(<<<<<<<|>>>>>>>)( |$)' -- . 2>/dev/null)
[ -z "$marked" ] || fail "a merge is not finished:
$marked"

# Which folders the files of a folder may include, and why, from the lowest folder to the highest. A folder that
# is in no other folder's list may not be included.
room() { # folder, folders it may include, why
    folder=$1 allowed=$2 why=$3
    found=$(grep -nE '#include "[^"]*/' "$folder"/*.[ch] "$folder"/*.[ch]pp 2>/dev/null |
        grep -vE "#include \"(${allowed:-nothing}|$folder)/[^/\"]*\"")
    [ -z "$found" ] || fail "$folder may include only ${allowed:-itself}: $why
$found"
}
common='server/base'
room protocol '' 'both sides speak by it'
room protocol/messages 'protocol' 'what is said comes after how it is sent'
room client/lib/sheen '' 'it is installed, without other files'
room client/lib 'protocol|protocol/messages|sheen' 'a client needs nothing of the daemon'
room client/lib/files 'client/lib|protocol' 'reading files for uploads needs no session'
room client/lib/numbers 'client/lib|protocol|protocol/messages' 'requests of computed numbers are made of what requests of frames are made of'
room client/cli/base 'client/lib|protocol' 'every part of the command knows it'
room client/cli/files 'client/lib|client/cli/base|protocol' 'files as they are sent, without options and sessions'
room client/cli/options 'client/lib|protocol' 'the command line is data'
cli='client/cli/base|client/cli/files|client/cli/options'
room client/cli/output "client/lib|$cli|protocol" 'what an answer looks like, wherever it comes from'
room client/cli/compare "client/cli|client/lib|$cli|client/cli/output|protocol" 'a command of several files; commands.h declares it'
room client/cli "client/lib|$cli|client/cli/output|protocol" 'the command is libsheen'"'"'s first user'
room client/cli/stream "client/cli|client/lib|$cli|client/cli/output|protocol" 'a command of several files'
room client/cli/lines "client/cli|client/lib|$cli|client/cli/output|protocol" 'a command of several files'
room deploy/manual 'client/cli|client/cli/options|client/lib|server/ops' 'manual pages are written from the tables of options'
room server/base 'protocol' 'everybody knows it'
room server/cage "$common" 'a cage is data: no format, no surface'
room server/cage/build "$common|server/cage" 'a cage is made the same from every format'
room server/cage/read/numbers '' 'numbers and matrices are the same in every format'
room server/cage/read/gltf "$common|server/cage|server/cage/build|server/cage/read/numbers" 'tinygltf stays behind one function'
room server/cage/read/usd "$common|server/cage|server/cage/build|server/cage/read/numbers" 'USD stays behind one function'
room server/cage/read "$common|protocol|server/cage|server/cage/build|server/cage/read/gltf|server/cage/read/numbers|server/cage/read/usd" 'the door to all readers'
room server/surface "$common" 'what a surface is to everybody else knows no builder, no cage'
room server/surface/topology "$common|server/cage" 'connectivity is of the cage, whatever its scheme'
room server/surface/subdivision "$common|server/cage|server/surface|server/surface/topology" 'builders of one kind of surface'
room server/surface/spline "$common|server/cage|server/surface" 'the builder of patches knows none of subdivision'
room server/surface/plan "$common|server/cage|server/surface|server/surface/spline|server/surface/subdivision" 'chooses the builder of a model'
room server/image "$common|protocol" 'pictures are data'
room server/sandbox "$common|server/cage|server/cage/read|server/image" 'the worker programs see files alone'
room server/scene "$common|protocol|protocol/messages|server/cage|server/surface" 'a request is data'
room server/curves "$common|server/scene|server/surface" 'numbers on surfaces: no cage, no device, no client'
room server/curves/fields "$common|server/curves|server/scene|server/surface" 'lines as zero sets of functions'
for kind in breaks compare lines; do
    room server/curves/$kind "$common|protocol|server/curves|server/curves/fields|server/scene|server/surface" 'no computation knows another'
done
room server/render "$common|protocol|server/image|server/scene|server/surface" 'what every device needs, so no GL'
room server/render/gl/context "$common|server/image" 'a context knows nothing of what is drawn in it'
room server/render/gl/programs "$common|server/scene" 'a program is a text and a name, whatever it draws'
room server/render/gl/maker "$common|server/image|server/scene|server/render/gl|server/render/gl/context|server/render/gl/programs" \
    'what runs on the thread that makes programs'
room server/render/gl "$common|server/image|server/scene|server/render|server/render/gl/context|server/render/gl/maker|server/render/gl/programs" \
    'a device draws, it serves nobody'
room server/render/native "$common|protocol|server/image|server/scene|server/surface|server/render|server/render/native/clip|server/render/native/frame|server/render/native/lanes|server/render/native/polygons|server/render/native/programs|server/render/native/rays" \
    'processors draw without GL'
room server/render/native/clip "$common|server/surface|server/render|server/render/native" 'clipping knows pieces'
room server/render/native/frame "$common|server/scene|server/render|server/render/native|server/render/native/polygons" 'what a frame goes through'
room server/render/native/polygons "$common|server/render|server/render/native|server/render/native/clip" 'polygons come after the surface'
room server/render/native/programs '' 'what shaders/lanes writes includes this and no more'
room server/render/native/rays "$common|server/surface|server/render|server/render/native" 'rays of pixels come after the surface'
room server/render/native/lanes "$common|server/surface|server/render|server/render/native|server/render/native/polygons|server/render/native/rays" 'one unit for each instruction set'
# The folders of the service. Each may include folders listed before it and none after it.
room server/net "$common|protocol" 'connections do not know what is said over them'
room server/threads "$common|server/cage|server/image|server/net|server/render|server/sandbox" \
    'threads run what others give them'
room server/output "$common|protocol|protocol/messages|server/image|server/render|server/scene|server/threads" \
    'an encoder knows pictures, no client'
room server/assets "$common|protocol|protocol/messages|server/cage|server/net|server/render|server/scene|server/surface|server/surface/plan|server/threads" \
    'models and images serve every frame, and know none'
room server/frame "$common|protocol|protocol/messages|server/assets|server/curves|server/curves/breaks|server/curves/compare|server/curves/fields|server/curves/lines|server/output|server/scene" \
    'a frame tells its session by events (request.h), so it includes none'
room server/session "$common|protocol|protocol/messages|server/assets|server/frame|server/net|server/output|server/threads" \
    'a session is one client'"'"'s messages; the main service hands it what it needs'
room server/ops "$common|protocol|server/assets|server/frame|server/net|server/output|server/render/gl|server/render/native|server/sandbox|server/session|server/threads" \
    'the daemon as a whole: nobody includes it'

no_include() { # folder, pattern of what it must not include, why
    found=$(grep -rnE "#include \"($2)" "$1")
    [ -z "$found" ] || fail "$1 must not include $2: $3
$found"
}
no_include server/cage/read 'protocol/([^m]|m[^o])' 'of the protocol a reader knows model_format.h alone'
no_include server/image 'protocol/([^s]|s[^r])' 'of the protocol pictures know srgb.h alone'
no_include server/render 'protocol/([^s]|s[^r])' 'of the protocol a device knows srgb.h alone'
no_include server/scene 'server/surface/([^tv]|t[^a]|v[^e])' 'of a surface a request knows tables.h and vec.h alone'
no_include server/curves 'protocol/([^b]|b[^r])' 'of the protocol computations know the records of breaks alone'
no_include server/ops 'server/render/([^gn]|g[^l]|(gl|native)/[^d]|(gl|native)/device_|n[^a])' 'a device is chosen by its device.h alone'
no_include server/render 'server/surface/(bicubic|texels)' 'of which degree patches are is the business of server/surface'
no_include server/scene 'server/surface/(bicubic|texels|patch|evaluate|bound)' 'a request knows the size of a surface, not the surface'
no_include server/assets 'server/surface/(bicubic|texels|patch|evaluate|bound|node|subdivision|spline)' 'models are built and kept, not looked into'
no_include server/threads 'server/sandbox/([a-z]*_tasks|sandbox)\.h' 'what parses files from strangers is for the workers alone'
no_include client/cli 'client/lib/([^s]|s[^h])' 'of libsheen the command knows sheen.h alone'
no_include client/cli 'protocol/(address|codec|frame|tls)\.' 'of the protocol the command knows no byte: libsheen says it'
only_in '\bgl[A-Z][A-Za-z0-9]*\(|epoxy' 'GL' 'server client protocol' server/render/gl/
only_in '\b(socket|bind|listen|accept4?|connect|send|sendto|sendmsg|recv|recvfrom|recvmsg|setsockopt|socketpair)\(' \
    'socket calls' 'server client protocol' server/net/ server/ops/notify.c server/threads/starter.c server/threads/worker.c server/sandbox/pass.c client/lib/connection.c client/lib/private_daemon.c
only_in '\b(posix_spawnp?|vfork|exec[lv][a-z]*|system|popen)\(|[=?:] v?fork\(' 'child processes' 'server client protocol' \
    protocol/child.c server/sandbox/zygote.c server/threads/starter.c
only_in '\bSSL_|openssl/ssl' 'TLS' 'server client protocol' protocol/tls.c
only_in 'pthread_|<threads\.h>' 'threads' 'server/cage server/surface server/scene server/curves server/render server/image server/sandbox protocol' \
    server/render/native/team.c server/render/gl/programs/kept_programs.c server/render/gl/maker/maker.c \
    server/surface/subdivision/maker.c
only_in '<[a-z0-9]*intrin\.h>|\b_mm[0-9]*_' 'intrinsics' 'server client protocol' server/render/native/
only_in '\b(strcpy|strcat|sprintf|vsprintf|gets|atoi|atof|alloca)\(' 'banned functions' \
    'server client protocol'
only_in '#include <OpenImageIO|OIIO::' 'OpenImageIO code' 'server client protocol' server/image/image.cpp
only_in '#include <turbojpeg|\btj[A-Z][A-Za-z0-9]*\(' 'libjpeg-turbo code' 'server client protocol' server/output/jpeg.c
only_in '#include <jansson' 'jansson code' 'server client protocol' client/lib/files/gltf_pack.c
only_in '#include <zlib|\b(deflate[A-Za-z0-9]*|inflate[A-Za-z0-9]*|crc32|adler32)(_combine)?\(' 'zlib code' \
    'server client protocol' server/output/png.c
only_in '#include <tiny_?gltf|tinygltf::' 'tinygltf code' 'server client protocol' server/cage/read/gltf/

# The types of the Python package.
if command -v mypy >/dev/null; then
    made=$(mktemp -d)
    PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 client/python/package.py 0 "$made/package" &&
        (cd "$made/package" && mypy --strict --enable-incomplete-feature=Unpack --cache-dir="$made/cache" -p sheen) >"$made/found" 2>&1 ||
        fail "mypy: $(cat "$made/found")"
    rm -rf "$made"
else
    echo "lint: NOT CHECKED: the types of client/python, because mypy is not installed (sh deploy/deps.sh)"
fi

# The list of files that a frame passes (CONTRIBUTING.md).
for file in $(grep -oE '`(server|client|protocol)/[a-z0-9/_]+\.[a-z]+`' CONTRIBUTING.md | tr -d '`'); do
    [ -e "$file" ] || fail "CONTRIBUTING.md names $file, which is not there"
done

# No file may include itself through other files. NAME.c and NAME.h count as one file. The headers of libsheen name each
# other from their own folder. Prints each circle in the order of its includes; circles that share a file with an
# earlier one are left out.
# shellcheck disable=SC2086
circles=$(grep -E '^#include "' $(printf '%s\n' $files | grep -E '^(server|client|protocol)/') |
    sed -E 's,^([^:]*/)([^:/]*:#include ")(sheen/)?([^/"]*"),\1\2\1\3\4,
        s/^([^:]*):#include "([^"]*)".*/\1 \2/; s/\.[a-z]+( |$)/\1/g' |
    awk '$1 != $2 && !seen[$1, $2]++ { to[$1] = to[$1] " " $2; left[$1] = 1 }
        # The first remaining file that a file includes.
        function next_of(file, i, n, list) {
            n = split(to[file], list, " ")
            for (i = 1; i <= n; i++)
                if (list[i] in left)
                    return list[i]
            return ""
        }
        # Removes files that include no remaining file, because they are in no circle.
        function peel(file, again) {
            do {
                again = 0
                for (file in left)
                    if (next_of(file) == "") {
                        delete left[file]
                        again = 1
                    }
            } while (again)
        }
        END {
            for (peel(); ; peel()) {
                start = ""
                for (file in left)
                    if (start == "" || file < start)
                        start = file
                if (start == "")
                    exit
                # After enough steps the walk is within the circle.
                for (i in left)
                    start = next_of(start)
                text = file = start
                do {
                    step = next_of(file)
                    text = text " -> " step
                    took[file] = 1
                    file = step
                } while (file != start)
                for (i in took)
                    delete left[i]
                print text
            }
        }')
[ -z "$circles" ] || fail "files that include each other in a circle:
$circles"

# A larger folder should be divided.
for folder in $(printf '%s\n' $files | grep -E '^(server|client|protocol)/' | sed 's|/[^/]*$||' | sort -u); do
    lines=$(printf '%s\n' $files | grep -E "^$folder/[^/]*$" | xargs cat | wc -l)
    [ "$lines" -le 3500 ] || fail "$folder has $lines lines, more than 3500"
done

# cppcheck reads no system headers. Without the macros of lists it reports the variables of their loops as
# uninitialised.
queue=$(echo '#include <sys/queue.h>' | cc -E - | sed -n 's/^# 1 "\(.*queue\.h\)".*/\1/p' | head -n 1)
cppcheck --quiet --std=c11 --language=c --inline-suppr --error-exitcode=1 -I. --include="$queue" \
    --enable=warning,performance,portability --suppress=missingInclude \
    --suppress=normalCheckLevelMaxBranches --suppress=unknownMacro \
    $(printf '%s\n' $files | grep -E '^(server|client|protocol|deploy)/.*\.c$') || fail "cppcheck"

[ "$failed" = 0 ] && echo "lint: clean"
exit "$failed"
