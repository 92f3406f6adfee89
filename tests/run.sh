#!/bin/bash
# run.sh unit|fuzz|bench|service|oracle|all|checked BUILD [NAME]: runs the tests of one kind, or all, or those that
# builds with sanitizers can run in an hour, or only the one named NAME. Each row has the seconds that passed and the seconds of processors. The last line is the sum,
# "N passed, N failed". Each program's whole output is kept in BUILD/tests/NAME.log. Programs that do not depend
# on time run in parallel, one more than there are processors, because some of them mostly wait. Tests of the
# service whose file contains ALONE run one by one after the others, because they also judge the order and the
# time of answers.
set -u
kind=$1 build=$2 only=${3:-}
at_once=$(($(nproc) + 1))
# These rows start first, so that none of them is left to run alone at the end.
long_rows="frames_shapes test_native_frames service_limits service_faults oracle_self filter lines areas \
service_access sheen_bench test_gpu_sources"
turn=long checked=
shapes=../shared/shapes
# In builds with sanitizers, leaks and races of other libraries are not reported.
export LSAN_OPTIONS="suppressions=tests/lsan.supp:print_suppressions=0"
# ThreadSanitizer writes its reports to files, because the output of the daemons under test is not kept.
reports=$(realpath "$build")/tests/race
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp:print_suppressions=0:log_path=$reports"
# The device that oracles judge, as in sheend's --device and --native-isa; mesa: Mesa's software device.
mesa=$(/usr/bin/python3 tests/service/mesa.py)
device=${DEVICE:-native}
[ "$device" != mesa ] || device=$mesa
export SHEEN_TEST_DEVICE="$device" SHEEN_TEST_ISA="${ISA:-auto}"
mkdir -p "$build/tests"
# All tests of this build share what Mesa has compiled.
MESA_SHADER_CACHE_DIR=$(realpath "$build/tests")/shaders
export MESA_SHADER_CACHE_DIR
rm -f "$build"/tests/*.count "$reports".*

# The last "N passed, N failed" a program printed, or cmocka's own count.
count() {
    sed -n -e 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p' \
        -e 's/^\[  PASSED  \] \([0-9]*\) test.*/\1 0/p' "$1" | tail -n 1
}

# Sums what `times` has written into a file: the seconds of processors that the children of a shell have taken.
processor_s() { # file
    tail -n 1 "$1" | sed 's/[ms]/ /g' | awk '{ printf "%.0f", 60 * ($1 + $3) + $2 + $4 }'
}

# Runs one program, and writes its counts to BUILD/tests/NAME.count, so that programs may run in parallel.
run() { # name, command...
    name=$1
    shift
    [ -z "$only" ] || [ "$only" = "$name" ] || return
    log=$build/tests/$name.log
    start=$(date +%s)
    times >"$log.before" # here: a subshell would begin its own count
    "$@" >"$log" 2>&1
    code=$?
    times >"$log.after"
    worked=$(($(processor_s "$log.after") - $(processor_s "$log.before")))
    rm "$log.before" "$log.after"
    set -- $(count "$log")
    ok=${1:-0} bad=${2:-0}
    [ $code = 0 ] || [ "$bad" != 0 ] || bad=1
    [ $code = 0 ] && [ "$ok" = 0 ] && [ "$bad" = 0 ] && bad=1
    echo "$ok $bad" >"$build/tests/$name.count"
    printf '%-28s %5d passed %4d failed %5d s %5d s of processors\n' "$name" "$ok" "$bad" \
        $(($(date +%s) - start)) "$worked"
    [ "$bad" = 0 ] || { tail -n 40 "$log"; }
}

# As run, in the background, as soon as fewer than $at_once programs are running. Does nothing when it is not the
# row's turn.
beside() { # name, command...
    case " $long_rows " in
    *" $1 "*) [ "$turn" = long ] || return 0 ;;
    *) [ "$turn" = short ] || return 0 ;;
    esac
    while [ "$(jobs -rp | wc -l)" -ge "$at_once" ]; do
        wait -n
    done
    run "$@" &
}

# Runs a command that calls `sheen`, with one daemon for all its pictures. Otherwise each `sheen` would start a
# private daemon, which takes longer than most pictures; the service's tests cover private daemons.
served() { # command...
    address=unix:$build/tests/$name.sock
    rm -f "${address#unix:}"
    "$build/sheend" --listen "$address" --log-level warn --device "$SHEEN_TEST_DEVICE" \
        --native-isa "$SHEEN_TEST_ISA" &
    daemon=$!
    for _ in $(seq 100); do
        [ -S "${address#unix:}" ] && break
        sleep 0.1
    done
    SHEEN_SERVER=$address oracle_program "$@"
    code=$?
    kill "$daemon" && wait "$daemon" || echo "the daemon ended with $?"
    return "$code"
}

# Oracles allocate and free hundreds of megabytes for each frame. They keep freed memory, because a new page from
# the system costs more than the writing into it. They also ask for large pages: without these test_frames takes 1.3
# times the processor time, and test_filter 1.5 times.
oracle_program() { # command...
    MALLOC_MMAP_THRESHOLD_=1073741824 MALLOC_TRIM_THRESHOLD_=2147483647 GLIBC_TUNABLES=glibc.malloc.hugetlb=1 "$@"
}

# Runs a command on Mesa's software device.
on_mesa() { # command...
    SHEEN_TEST_DEVICE=$mesa SHEEN_TEST_ISA=auto "$@"
}

# The shapes that match a pattern.
shapes_of() { # pattern
    [ -d "$shapes" ] || return 0
    for shape in "$shapes"/$1; do
        echo "$shape"
    done
}

unit() {
    # SIGBUS reaches test_threads_worker's programs, and AddressSanitizer would report it as a fault.
    local -x ASAN_OPTIONS=handle_sigbus=0
    # Mesa compiles without LLVM's optimisations: unit tests draw many kinds of small frames, for which compiling takes
    # longer than drawing. test_native_frames takes half of the processor time (empty cache). The oracles' rows on
    # Mesa draw more, and keep the optimisations.
    local -x GALLIVM_PERF=nopt LP_NATIVE_VECTOR_WIDTH=128
    for test in tests/unit/test_*.c; do
        name=$(basename "$test" .c)
        case $name in
        # Leaks of OpenImageIO are distinguished from sheen's by complete stacks only.
        test_image) beside "$name" env ASAN_OPTIONS=fast_unwind_on_malloc=0 "$build/tests/$name" ;;
        # These draw so much that Mesa's code with optimisations saves more than it takes to compile.
        test_gpu_rounding | test_gpu_tiles)
            beside "$name" env -u GALLIVM_PERF -u LP_NATIVE_VECTOR_WIDTH "$build/tests/$name"
            ;;
        *) beside "$name" "$build/tests/$name" ;;
        esac
    done
    beside lanes /usr/bin/python3 tests/shaders/test_lanes.py "$build"
}

# Replays the corpora of the fuzz targets.
fuzz() {
    for corpus in tests/fuzz/corpus/*; do
        name=fuzz_$(basename "$corpus")
        beside "$name" "$build/tests/$name" "$corpus"
    done
}

bench() {
    beside sheen_bench /usr/bin/python3 tests/bench/test_sheen_bench.py "$build"
}

# Tests of the service, whose files grep finds by ALONE with option $1 (-L: without, -l: with); $2 runs each.
service_by() { # option, how
    # A sanitizer's runtime must be loaded before any library, also before the one that test_libraries preloads.
    for module in $(grep "$1" '^ALONE' ${checked:+--exclude=test_libraries.py} tests/service/test_*.py); do
        name=$(basename "$module" .py)
        "$2" "service_${name#test_}" env -u SHEEN_TEST_DEVICE /usr/bin/python3 tests/service/run.py "$build" "$name"
    done
}

service() {
    service_by -L beside
    beside same sh tests/oracle/test_same.sh "$build/sheen" "$build/sheend" tests/models/fender.gltf \
        tests/models/body.obj
}

service_alone() {
    service_by -l run
}

oracle() {
    [ -d "$shapes" ] || [ "$turn" = short ] || echo "note: $shapes is not here: the oracles judge tests/models only"
    cages=$(shapes_of 'catmark_*.obj') all=$(shapes_of '*.obj')
    # shellcheck disable=SC2046,SC2086 # lists of files without spaces
    [ -z "$cages" ] || beside frames_shapes served "$build/tests/test_frames" --library $cages
    beside frames_models served "$build/tests/test_frames" "$build/sheen" tests/models/*.obj \
        tests/models/*.gltf
    beside oracle_self served sh tests/oracle/self_test.sh "$build/tests"
    beside oracle_osd "$build/tests/test_oracle"
    beside limit "$build/tests/test_limit" tests/models/*.obj $all
    beside refine "$build/tests/test_refine" tests/models/*.obj tests/models/*.gltf $all
    # The surface of loop_val2_interior folds onto itself and has no normal along the fold.
    beside twin "$build/tests/test_twin" tests/models/*.obj \
        $(printf '%s\n' $all | grep -v loop_val2_interior)
    beside deep "$build/tests/test_deep"
    beside line_position "$build/tests/test_line_position"
    beside line_ends "$build/tests/test_line_ends"
    # shellcheck disable=SC2046 # a list of files without spaces
    beside comparison "$build/tests/test_comparison" $(shapes_of 'catmark_car.obj')
    beside comparison_pairs "$build/tests/test_comparison_pairs"
    oracle_of_code
    car=$shapes/catmark_car.obj
    [ -f "$car" ] || car=tests/models/creases.obj
    beside far served "$build/tests/test_far" "$build/sheen" tests/models/fender.obj "$car"
    beside zoom served "$build/tests/test_zoom" "$build/sheen" tests/models/body.obj tests/models/fender.obj \
        tests/models/creases.obj tests/models/pole.obj "$car"
    beside filter served "$build/tests/test_filter" "$build/sheen" tests/models/fender.obj \
        tests/models/body.obj tests/models/ngons.obj tests/models/creases.obj "$car"
    # shellcheck disable=SC2046 # a list of files without spaces
    beside shares "$build/tests/test_shares" tests/models/plane.obj tests/models/body.obj \
        tests/models/fender.obj tests/models/creases.obj "$car" \
        $(shapes_of 'catmark_torus.obj') $(shapes_of 'catmark_bishop.obj')
    beside patterns served "$build/tests/test_patterns" "$build/sheen" tests/models/plane.obj
    # shellcheck disable=SC2046 # lists of files without spaces
    beside areas served "$build/tests/test_areas" "$build/sheen" tests/models/body.obj \
        tests/models/fender.obj tests/models/plane.obj tests/models/sheet.obj \
        tests/models/ngons.obj $(shapes_of 'catmark_toroidal_tet.obj') \
        $(shapes_of 'catmark_torus.obj')
    beside lines served "$build/tests/test_lines" "$build/sheen" tests/models/fender.obj \
        tests/models/body.obj tests/models/creases.obj tests/models/pole.obj "$car"
    beside numbers "$build/tests/test_numbers" tests/models/plane.obj tests/models/body.obj \
        tests/models/fender.obj
    beside fine served "$build/tests/test_fine" "$build/sheen" tests/models/plane.obj tests/models/fender.obj
    beside isophotes served "$build/tests/test_isophotes" "$build/sheen" tests/models/body.obj
    beside mirror served "$build/tests/test_mirror" "$build/sheen"
    [ "$SHEEN_TEST_DEVICE" = "$mesa" ] || oracle_on_mesa
}

# Oracles that call the product's code with surfaces of many kinds, and draw nothing.
oracle_of_code() {
    beside breaks "$build/tests/test_breaks"
    beside random_cages "$build/tests/test_random_cages"
    beside sectors "$build/tests/test_sectors"
}

# The tests that also run on Mesa's software device. README.md tells how they were chosen.
oracle_on_mesa() {
    beside mesa_frames on_mesa served "$build/tests/test_frames" "$build/sheen" tests/models/body.obj \
        tests/models/creases.obj
    beside mesa_shares on_mesa "$build/tests/test_shares" tests/models/body.obj tests/models/creases.obj
    beside mesa_filter on_mesa served "$build/tests/test_filter" "$build/sheen" tests/models/ngons.obj
    beside mesa_lines on_mesa served "$build/tests/test_lines" "$build/sheen" tests/models/body.obj
}

# Runs the rows of these kinds in parallel, the longest first.
in_parallel() { # kind...
    for turn in long short; do
        for rows; do
            "$rows"
        done
    done
    wait
}

case $kind in
all)
    in_parallel oracle service unit fuzz bench
    service_alone
    ;;
checked)
    checked=yes
    in_parallel oracle_of_code service unit fuzz
    service_alone
    ;;
service)
    in_parallel service
    service_alone
    ;;
unit | fuzz | bench | oracle) in_parallel "$kind" ;;
*)
    echo "usage: run.sh unit|fuzz|bench|service|oracle|all|checked BUILD [NAME]" >&2
    exit 2
    ;;
esac
for report in $(grep -l 'WARNING: ThreadSanitizer' "$reports".* 2>/dev/null); do
    head -n 60 "$report"
    echo '0 1' >"$build/tests/$(basename "$report").count"
done
[ -z "$only" ] || [ -f "$build/tests/$only.count" ] || echo "no test is named $only: tests/README.md" >&2
cat "$build"/tests/*.count 2>/dev/null | awk '{ passed += $1; failed += $2 }
    END { print passed + 0 " passed, " failed + 0 " failed"; exit !(passed > 0 && failed == 0) }'
