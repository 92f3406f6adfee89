#!/bin/sh
# self_test.sh FOLDER: runs the oracles in FOLDER on frames made by FOLDER/fake_sheen. They must accept right
# frames and find each inserted fault. Ends with "N passed, N failed".
set -u
folder=$1
fake=$folder/fake_sheen
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# A body with eight vertices of valence 3.
cat >"$work/cube.obj" <<END
v -1 -1 1
v 1 -1 1
v -1 1 1
v 1 1 1
v -1 1 -1
v 1 1 -1
v -1 -1 -1
v 1 -1 -1
f 1 2 4 3
f 3 4 6 5
f 5 6 8 7
f 7 8 2 1
f 2 8 6 4
f 7 1 3 5
END

verdict() { # name, whether it holds
    if [ "$2" = 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $1"
        tail -n 12 "$work/log"
    fi
}

# run PROGRAM MODEL-or-nothing FAULTS: writes the output to $work/log and sets $code to the exit code
run() {
    case $1 in
    test_limit | test_twin | test_refine) FAKE_FAULTS=$3 "$folder/$1" "$2" >"$work/log" 2>&1 ;;
    test_frames) FAKE_FAULTS=$3 "$folder/$1" --small "$fake" "$2" >"$work/log" 2>&1 ;;
    test_numbers) FAKE_FAULTS=$3 "$folder/$1" tests/models/plane.obj "$2" >"$work/log" 2>&1 ;;
    *) FAKE_FAULTS=$3 "$folder/$1" "$fake" ${2:+"$2"} >"$work/log" 2>&1 ;;
    esac
    code=$?
}

clean() { # program, model
    run "$1" "$2" ""
    verdict "$1 passes a right frame" "$code"
}

# finds PROGRAM MODEL FAULTS MESSAGE...: expects exit code 1 and each message in a FAILED line
finds() {
    program=$1 model=$2 faults=$3
    shift 3
    run "$program" "$model" "$faults"
    [ "$code" = 1 ]
    verdict "$program fails on: $faults" $?
    for message; do
        grep -q -F -- "$message" "$work/log"
        verdict "$program says: $message" $?
    done
}

clean test_limit "$work/cube.obj"
finds test_limit "$work/cube.obj" point,deep,hole,neighbour \
    "normal p99.9" "position p99.9" "gap at ring seams" "normals across ring seams" \
    "only one has a surface" "wrong neighbours"
finds test_limit "$work/cube.obj" frame "normal p99.9"

clean test_twin "$work/cube.obj"
finds test_twin "$work/cube.obj" point,frame "its twin: gap" "its rewound twin: gap" \
    "its twin: normal p99.9" "at edges: gap" "at edges: normal p99.9" "between leaves: normal p99.9"
finds test_twin "$work/cube.obj" hole "only one has a surface"

clean test_refine "$work/cube.obj"

clean test_frames "$work/cube.obj"
finds test_frames "$work/cube.obj" normal,unit,position,curvature,residual,winding,range,nan \
    "normal p99.9" "position p99.9" "curvature p99.9" "residual p99.9" "residual max" "| |N| - 1 |" \
    "normals against the winding" "no surface at (face,u,v)" "hit, P and N disagree"
finds test_frames "$work/cube.obj" silent "no camera in the JSON"
finds test_frames "$work/cube.obj" types "channel N.X is of type"
finds test_frames "$work/cube.obj" refuse "sheen render ended with 3"
finds test_frames "$work/missing.obj" "" "MISSING: $work/missing.obj"
fake=/nonexistent
finds test_frames "$work/cube.obj" "" "sheen render ended with -1"
fake=$folder/fake_sheen

finds test_frames "$work/cube.obj" hole,stray,face,layer \
    "holes" "hit outside the surface" "a face that is not visible" "before or behind"

clean test_mirror ""
finds test_mirror "" normal,position,bend,miss,colour \
    "normal (rad)" "|z|" "light s, t" "bend of a stripe edge" "wrong side of the light" \
    "wrong colour"

# These faults are in the oracle's own formulas of lines; the frames are those of the real program.
fake=$folder/../sheen
clean test_lines "$work/cube.obj"
finds test_lines "$work/cube.obj" mirror,turn,side,isophote,duty,eye \
    "rectangle stripes: (s,t) of P and N" "sphere rainbow: (s,t) of the surface" \
    "narrow tunnel distance: " "rectangle stripes: change of (s,t)" \
    "isophote axis: (s,t) of P and N" "eye at a point: (s,t) of P and N" \
    "rectangle stripes: " "pixels of the wrong colour"

finds test_numbers "$work/cube.obj" mirror,turn,side,isophote \
    "sphere's pole: (s,t) by what rounding explains" "pixels on the wrong side of a border" \
    "reflection sphere: (s,t) by what rounding explains" \
    "isophote plane: (s,t) by what rounding explains" \
    "environment sphere: (s,t) by what rounding explains"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
