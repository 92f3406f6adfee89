#!/bin/sh
# Installs the Debian packages for building, running and testing sheen. Does nothing if all are
# installed, so that it needs root only once. `deps.sh fuzz` adds the packages of make fuzz.
set -eu
packages="gcc g++ gcc-aarch64-linux-gnu g++-aarch64-linux-gnu libc6-dev-arm64-cross make pkg-config python3 python3-protobuf protobuf-compiler nanopb libnanopb-dev
 libepoxy-dev libegl-dev libegl1 libopengl0 libgl1-mesa-dri glslang-tools libopenimageio-dev libtinygltf-dev
 nlohmann-json3-dev libjansson-dev libzstd-dev zlib1g-dev libturbojpeg0-dev libssl-dev libinih-dev libpng-dev
 fonts-dejavu-core libcmocka-dev libosd-dev libopenexr-dev libembree-dev clang-format cppcheck systemd openssl git
 mandoc zsh fish python3-numpy python3-zstandard mypy libxml2-utils"
[ "${1:-}" = fuzz ] && packages="$packages clang-14 libclang-rt-14-dev"
missing=
for package in $packages; do
    state=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)
    case $state in
    ii*) ;;
    *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0
echo "installing:$missing"
as_root=
if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || {
        echo "deps: run this as root, or install:$missing" >&2
        exit 1
    }
    as_root=sudo
fi
$as_root apt-get update -qq
# shellcheck disable=SC2086 # a list of words
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
