#!/bin/sh
# pictures.sh MODEL FOLDER: draws the pictures of README.md. three_looks.jpg shows the results of its first
# commands, contact_sheet.jpg every line family, light and pattern, patches.jpg a model of Bezier patches.
# Needs oiiotool (Debian: openimageio-tools) and the programs of `make`.
set -eu
[ $# = 2 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
command -v oiiotool >/dev/null || { echo "$0: oiiotool is missing: apt-get install openimageio-tools" >&2; exit 2; }
sheen=$(dirname "$0")/../build/sheen
model=$1 folder=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
n=100

mosaic() { # columns x rows, file; takes the panels so far
    oiiotool "$work"/1*.png --mosaic:pad=4 "$1" --ch R,G,B -d uint8 --attrib "quality" 90 \
        -o "$folder/$2"
    rm "$work"/1*.png
}

panel() { # title, options of sheen render
    title=$1
    shift
    n=$((n + 1))
    "$sheen" render "$model" -o "$work/panel.png" --size 400x260 -q "$@"
    oiiotool "$work/panel.png" --text:x=10:y=250:size=16:font=DejaVuSans:color=1,1,1,1 "$title" \
        -o "$work/$n.png"
}

panel "--lines zebra" --lines zebra
panel "no option: a tunnel of lights"
panel "--show mean" --show mean --legend off
mosaic 3x1 three_looks.jpg

panel "reflection, rectangle" --light rectangle
panel "highlight, plane" --lines highlight --light plane
panel "isophote, from the eye" --lines isophote --pattern stripes:count=36
panel "zebra" --lines zebra --pattern stripes:count=30
panel "tunnel, duty=0.3" --light tunnel --pattern stripes:count=24,duty=0.3
panel "sphere, soft=0.6" --light sphere --pattern stripes:count=48,soft=0.6
panel "lattice" --pattern lattice:count=30,duty=0.15
panel "circles" --light rectangle --pattern circles:count=20
panel "single lines, soft=0.3" --pattern lines:at=0.2/0.3/0.4/0.5/0.6/0.7/0.8,width=0.012,soft=0.3
panel "rainbow" --pattern rainbow:count=10
panel "distance" --light rectangle --pattern distance:count=40
panel "two lights, opacity" --light rectangle \
    --pattern lines:at=0.35/0.5/0.65,width=0.02,fg=#d02020,bg=#00000000 \
    --light tunnel --pattern stripes:count=24,opacity=0.5
mosaic 4x3 contact_sheet.jpg

model=$(dirname "$0")/../tests/models/bottle.bpt
panel "zebra" --lines zebra --pattern stripes:count=16 --up z --view right
panel "a tunnel of lights" --pattern stripes:count=20 --up z --view iso
panel "--show gaussian" --show gaussian --legend off --up z --view right
mosaic 3x1 patches.jpg
