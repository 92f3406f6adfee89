#!/bin/sh
# coverage.sh BUILD NAME...: replays the corpora in a build with --coverage, and prints the share of lines that
# they reach, for each file and for all files. Fails if the share of all is below 85 of 100.
set -eu
build=$1
shift
find "$build" -name '*.gcda' -delete
for name in "$@"; do
    "$build/tests/fuzz_$name" "tests/fuzz/corpus/$name" >/dev/null
done
# The protocol, the readers, and the code that reads answers of workers.
for object in "$build"/obj/protocol/*.gcno "$build"/obj/protocol/messages/*.gcno "$build"/obj/server/cage/*.gcno \
    "$build"/obj/server/cage/build/*.gcno "$build"/obj/server/cage/read/*.gcno "$build"/obj/server/cage/read/*/*.gcno \
    "$build"/obj/server/sandbox/stream.*.gcno "$build"/obj/server/sandbox/job.*.gcno "$build"/obj/server/sandbox/*_code.*.gcno; do
    gcov -n -s "$(pwd)" -r "$object" 2>/dev/null
done | awk -v least=85 '
    /^File/ { file = $2; gsub(/\047/, "", file) }
    /^Lines executed/ && file ~ /\.(c|cpp)$/ && !(file in seen) {
        seen[file] = 1
        split($0, part, /[:%]/)
        printf "%6.1f %% of %4d  %s\n", part[2], $NF, file
        lines += $NF
        reached += $NF * part[2] / 100
    }
    END {
        printf "%6.1f %% of %4d  all\n", 100 * reached / lines, lines
        exit !(lines > 0 && 100 * reached >= least * lines)
    }'
