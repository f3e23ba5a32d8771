#!/usr/bin/env bash
# Installs a portable build, runs the program with each variant of its library that this processor can
# run, and compares what a small run writes, byte by byte. Exits 77 where the loader knows of no
# variants.
#
#   variants_agree.sh CMAKE BUILD
set -euo pipefail

fail() { echo "variants_agree: $1" >&2; exit 1; }

tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
"$1" --install "$2" --prefix "$tree/installed" >/dev/null
mv "$tree/installed" "$tree/moved"  # the program finds its library from where it lies
[ ! -e "$tree/moved/include" ] || fail "headers are installed of a library that no program can link"
burnish=$tree/moved/bin/burnish
loader=$(ldd "$burnish" | sed -n 's/^[[:space:]]*\(\/[^ ]*\/ld-linux[^ ]*\) .*/\1/p')
[ -n "$loader" ] || fail "$burnish names no loader"
if ! help=$("$loader" --help) || ! grep -q glibc-hwcaps <<<"$help"; then
    echo "variants_agree: $loader knows of no variants" >&2
    exit 77
fi
newer=$(sed -n 's/^ *\(x86-64-v[34]\) (supported, searched).*/\1/p' <<<"$help" | tac)

baseline=$(uname -m | sed 's/_/-/')
best=$baseline
for variant in $baseline $newer; do
    run() { "$loader" --glibc-hwcaps-mask "$variant" "$burnish" "$@"; }
    said=$(run --version)
    [[ $said == *", $variant)" ]] || fail "$variant was asked for; the program says: $said"
    mkdir "$tree/$variant"
    # A folder of the same name for all, for reports name it.
    (cd "$tree/$variant" && run optimize --size 96 96 --iterations 6 --target-spp 16 --evaluation-spp 16 \
        --set path_cache.window=4 -o descent >log.txt 2>&1) || fail "$variant: $(cat "$tree/$variant/log.txt")"
    pictures=$(cd "$tree/$variant/descent" && find . -name '*.exr' | sort)
    [ -n "$pictures" ] || fail "$variant wrote no picture"
    for picture in $pictures; do
        cmp "$tree/$baseline/descent/$picture" "$tree/$variant/descent/$picture" ||
            fail "$picture of $variant is not that of $baseline"
    done
    best=$variant
    echo "variants_agree: $variant: $(wc -w <<<"$pictures") files agree"
done
[[ $("$burnish" --version) == *", $best)" ]] || fail "the loader chose $("$burnish" --version), not $best"
