#!/bin/sh
# fuzz.sh BUILD SECONDS NAME...: fuzzes each target for SECONDS, as many in parallel as there are processors.
# New inputs are added to BUILD/found/NAME; an input that fails is kept there as NAME-crash-*.
set -u
build=$1 seconds=$2
shift 2
for name in "$@"; do
    mkdir -p "$build/found/$name"
done
export ASAN_OPTIONS=allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
# shellcheck disable=SC2016 # for the inner shell
printf '%s\n' "$@" | xargs -P "$(nproc)" -I NAME sh -c '
    log=$1/found/$3.log
    "$1/tests/fuzz_$3" -max_total_time="$2" -timeout=10 -rss_limit_mb=2560 -max_len=8192 \
        -artifact_prefix="$1/found/$3-" -print_final_stats=1 "$1/found/$3" "tests/fuzz/corpus/$3" \
        >"$log" 2>&1
    code=$?
    runs=$(sed -n "s/^stat::number_of_executed_units: *//p" "$log")
    edges=$(grep -o " cov: [0-9]*" "$log" | tail -n 1 | grep -o "[0-9]*")
    [ $code = 0 ] || tail -n 60 "$log"
    printf "%-10s %10s runs %6s edges  %s\n" "$3" "${runs:-?}" "${edges:-?}" \
        "$([ $code = 0 ] && echo "no finding" || echo "FOUND: see $log")"
    exit $code
' sh "$build" "$seconds" NAME
