#!/bin/sh
# test_same.sh SHEEN SHEEND MODEL...: a private daemon, a daemon on a Unix socket and a daemon on loopback
# TCP give the same file for a frame, byte by byte, as PNG and as EXR. For the second frame of a model nothing
# is uploaded and no table is built.
set -u
if [ $# -lt 3 ]; then
    echo "usage: test_same.sh SHEEN SHEEND MODEL..." >&2
    exit 2
fi
sheen=$1 sheend=$2
shift 2
unset SHEEN_SERVER
work=$(mktemp -d) || exit 1
daemon=
stop_daemon() {
    if [ -n "$daemon" ]; then
        kill "$daemon" 2>/dev/null
        wait "$daemon" 2>/dev/null
    fi
    daemon=
}
trap 'stop_daemon; rm -rf "$work"' EXIT
trap 'exit 1' INT TERM
passed=0
failed=0

check() { # whether it holds (an exit code), what
    if [ "$1" = 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "  FAILED: $2"
    fi
}

start_daemon() { # address; into $daemon, and ready to answer, or 1
    "$sheend" --listen "$1" 2>"$work/daemon.log" &
    daemon=$!
    tries=0
    while ! "$sheen" stats --server "$1" >/dev/null 2>&1; do
        tries=$((tries + 1))
        if [ $tries -gt 100 ] || ! kill -0 "$daemon" 2>/dev/null; then
            stop_daemon
            return 1
        fi
        sleep 0.1
    done
}

start_on_free_port() { # into $address
    for offset in 0 1 2 3 4 5 6 7; do
        address=tcp:127.0.0.1:$((20000 + ($$ * 8 + offset) % 12000))
        start_daemon "$address" && return 0
    done
    return 1
}

number() { # key, file: the number that a JSON object has under the key
    grep -o "\"$1\": *[0-9]*" "$2" | grep -o '[0-9]*$' | head -n 1
}

uploaded() { # bytes that the daemon at $address has taken in
    "$sheen" stats --server "$address" --json >"$work/stats.json" && number uploads_bytes "$work/stats.json"
}

# render MODEL FILE [option]...: writes the JSON to FILE.json
render() {
    model=$1 file=$2
    shift 2
    case $file in *.exr) set -- --aov P,N,ptex,light "$@" ;; esac
    "$sheen" render "$model" -o "$file" --size 320x240 --json "$@" >"$file.json" 2>"$file.log"
    check $? "$model: sheen render $*: $(cat "$file.log")"
}

same() { # file, file, what
    [ -s "$1" ] && cmp "$1" "$2"
    check $? "$3"
}

through_daemon() { # name; the daemon is up at $address
    for model; do
        frame=$work/$(basename "$model")
        before=$(uploaded)
        render "$model" "$frame.$name.png" --server "$address"
        between=$(uploaded)
        render "$model" "$frame.$name.exr" --server "$address"
        after=$(uploaded)
        first=$(number tables_us "$frame.$name.png.json")
        second=$(number tables_us "$frame.$name.exr.json")
        printf '%-28s %-5s %10s %10s %12s %12s\n' "$(basename "$model")" "$name" "$first" \
            "$second" "$((between - before))" "$((after - between))"
        same "$frame.png" "$frame.$name.png" "$model: PNG by $name is not the private daemon's"
        same "$frame.exr" "$frame.$name.exr" "$model: EXR by $name is not the private daemon's"
        [ "${first:-0}" -gt 0 ]
        check $? "$model by $name: the first frame's tables_us is '$first'"
        [ "$second" = 0 ]
        check $? "$model by $name: the second frame's tables_us is '$second', not 0"
        [ $((between - before)) -ge "$(wc -c <"$model")" ]
        check $? "$model by $name: the first frame uploads $((between - before)) bytes"
        [ $((after - between)) = 0 ]
        check $? "$model by $name: the second frame uploads $((after - between)) bytes"
    done
}

# The client is small: it links none of the daemon's libraries.
heavy=$(ldd "$sheen" | grep -iE 'OpenImageIO|libE?GL|libepoxy|tinygltf')
[ -z "$heavy" ]
check $? "the client links $heavy"

# The limits of a patch's memory on the GPU.
"$sheen" info "$1" --json >"$work/info.json"
regular=$(number regular_bytes "$work/info.json") corner=$(number corner_bytes "$work/info.json")
[ "${regular:-0}" -gt 0 ] && [ "${regular:-0}" -le 320 ]
check $? "a regular patch takes $regular bytes, more than 320"
[ "${corner:-0}" -gt 0 ] && [ "${corner:-0}" -le 12400 ]
check $? "a corner patch takes $corner bytes, more than 12400"

for model; do
    render "$model" "$work/$(basename "$model").png"
    render "$model" "$work/$(basename "$model").exr"
done
printf '%-28s %-5s %10s %10s %12s %12s\n' model by "tables, us" "again, us" "upload, B" "again, B"
address=unix:$work/sheen.sock
start_daemon "$address"
check $? "sheend on a Unix socket: $(cat "$work/daemon.log")"
name=unix
[ -n "$daemon" ] && through_daemon "$@"
stop_daemon
start_on_free_port
check $? "sheend on loopback TCP: $(cat "$work/daemon.log")"
name=tcp
[ -n "$daemon" ] && through_daemon "$@"
stop_daemon

echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
