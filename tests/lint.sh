#!/bin/sh
# Format, static analysis, and who may know whom (CONTRIBUTING.md).
set -u
failed=0
fail() {
    echo "lint: $*"
    failed=1
}

# Files of a folder that hold a pattern, but for those named after it.
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

no_include() { # folder, pattern of what it must not include
    found=$(grep -rnE "#include \"($2)" "$1")
    [ -z "$found" ] || fail "$1 must not know $2:
$found"
}

files=$(git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp' '*.hpp' 2>/dev/null ||
    find server client protocol tests -name '*.[ch]' -o -name '*.cpp' -o -name '*.hpp')
# shellcheck disable=SC2086
clang-format --dry-run -Werror $files 2>&1 | grep -m 20 'error:' && fail "run make format"

no_include protocol 'server/|client/|shaders/'
no_include client 'server/'
no_include server/cage 'server/(limit|gpu|image|service|worker)|protocol/([^m]|m[^o])|client/'
no_include server/worker 'server/(limit|gpu|service)|protocol/|client/'
# What parses files from strangers is for the worker programs alone.
no_include server/service 'server/cage/read/|server/worker/([a-z]*_tasks|sandbox)\.h'
no_include server/gpu 'server/(cage/read|worker)/'
no_include server/limit 'server/(cage/read|worker)/'
no_include server/limit 'server/(gpu|image|service)|protocol/|client/'
no_include server/image 'server/(cage|limit|gpu|service|worker)|protocol/([^s]|s[^r])|client/'
no_include server/gpu 'server/service|protocol/([^rs]|r[^a]|s[^r])|client/'
no_include server/service 'client/|server/gpu/([^r]|r[^e]|re[^n]|render[^e])'
only_in '\bgl[A-Z][A-Za-z0-9]*\(|epoxy' 'GL' 'server client protocol' server/gpu/
only_in '\b(socket|bind|listen|accept4?|connect|send|sendto|sendmsg|recv|recvfrom|recvmsg|setsockopt|socketpair)\(' \
    'socket calls' 'server client protocol' server/service/ server/sandbox/zygote.c client/connection.c client/private_daemon.c
only_in '\bSSL_|openssl/ssl' 'TLS' 'server client protocol' protocol/tls.c
only_in 'pthread_|<threads\.h>' 'threads' 'server/cage server/limit server/gpu server/image server/worker protocol'
only_in '\b(strcpy|strcat|sprintf|vsprintf|gets|atoi|atof|alloca)\(' 'banned functions' \
    'server client protocol'
only_in '#include <OpenImageIO|OIIO::' 'OpenImageIO code' 'server client protocol' server/image/image.cpp
only_in '#include <turbojpeg|\btj[A-Z][A-Za-z0-9]*\(' 'libjpeg-turbo code' 'server client protocol' server/output/jpeg.c
only_in '#include <jansson' 'jansson code' 'server client protocol' client/gltf_pack.c
only_in '#include <zlib|\b(deflate[A-Za-z0-9]*|inflate[A-Za-z0-9]*|crc32|adler32)(_combine)?\(' 'zlib code' \
    'server client protocol' server/output/png.c
only_in '#include <tiny_?gltf|tinygltf::' 'tinygltf code' 'server client protocol' server/cage/read/gltf

cppcheck --quiet --std=c11 --language=c --inline-suppr --error-exitcode=1 -I. \
    --enable=warning,performance,portability --suppress=missingInclude \
    --suppress=normalCheckLevelMaxBranches --suppress=unknownMacro \
    $(printf '%s\n' $files | grep -E '^(server|client|protocol)/.*\.c$') || fail "cppcheck"

[ "$failed" = 0 ] && echo "lint: clean"
exit "$failed"
