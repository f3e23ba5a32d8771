#!/usr/bin/env bash
# Checks what the source files include. A layer (a folder of src/burnish) includes its own files and those of
# the layers before it; a third-party library is named in one place. Prints file:line for every violation and
# exits with 1 where there is one.
#
# check_layers.sh             checks this repository
# check_layers.sh --self-test seeds violations into a temporary tree and checks that each is found
set -euo pipefail
script=$(readlink -f "${BASH_SOURCE[0]}")

# To add a layer or a library, edit the tables in BEGIN. A layer's entry lists what it may include; the
# reading of scene files and the shading maths do not know each other.
# shellcheck disable=SC2016  # awk reads the dollar signs
rules='
BEGIN {
    allowed["core"]    = " core "
    allowed["image"]   = " core image "
    allowed["scene"]   = " core image scene "
    allowed["mitsuba"] = " core image scene mitsuba "
    allowed["shading"] = " core image scene shading "
    allowed["paths"]   = " core image scene mitsuba shading paths "
    allowed["render"]  = " core image scene mitsuba shading paths render "
    allowed["inverse"] = " core image scene mitsuba shading paths render inverse "
    allowed["reproduce"] = " core image scene mitsuba shading paths render inverse reproduce "
    allowed["app"]     = " core image scene mitsuba shading paths render inverse reproduce app scenes "
    # The algorithm once more: of the layers above render only what theta is.
    allowed["reference"] = " core image scene mitsuba shading paths gradient reference "
    allowed["scenes"]  = " core image scenes "

    library["^embree[0-9]*/"]                     = "^src/burnish/paths/"
    library["^(tbb|oneapi)/"]                     = "^src/burnish/core/parallel[^/]*$"
    library["^(OpenEXR/|Imath/|Imf|Imath|Iex|half[.]h)"] = "^src/burnish/image/"
    library["^(png|jpeglib|jerror)[.]h$"]         = "^src/burnish/image/"
    library["^(stb/)?stb_"]                       = "^src/burnish/image/"
    library["^(pugixml|tiny_obj_loader)[.]h"]     = "^src/burnish/mitsuba/"
    library["^(CLI|spdlog|nlohmann)/"]            = "^src/burnish/app/"
}
function report(text) {
    printf "%s:%d: %s\n", FILENAME, FNR, text
    violations++
}
function layer_of(path) {
    if (path ~ /^scenes\//) return "scenes"
    sub(/^(src\/)?burnish\//, "", path)
    sub(/\/.*/, "", path)
    return path
}
/^[ \t]*#[ \t]*include[ \t]*["<]/ {
    header = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*["<]/, "", header)
    sub(/[">].*/, "", header)
    from = layer_of(FILENAME)
    if (!(from in allowed)) {
        report("the folder \"" from "\" is no layer; layers are listed in scripts/check_layers.sh")
        next
    }
    if (header ~ /^(burnish|scenes)\//) {
        to = layer_of(header)
        if (index(allowed[from], " " to " ") == 0)
            report("layer \"" from "\" includes " header " of layer \"" to "\", which it may not know")
        next
    }
    for (pattern in library) {
        if (header ~ pattern) {
            if (FILENAME !~ library[pattern])
                report("includes " header ", which belongs to files that match " library[pattern])
            next
        }
    }
    if ($0 ~ /include[ \t]*"/)
        report("includes \"" header "\"; own headers are named from the root (burnish/...)")
}
END { exit violations > 0 }
'

check() {  # check ROOT
    cd "$1"
    find src/burnish scenes -name '*.h' -o -name '*.cpp' | sort | xargs -r awk "$rules"
}

self_test() {
    local expected found
    tree=$(mktemp -d)  # global: the trap outlives this function
    trap 'rm -rf "$tree"' EXIT
    mkdir -p "$tree"/src/burnish/{core,image,mitsuba,shading,paths,app} "$tree"/scenes
    cd "$tree"
    echo '#include "burnish/core/vec.h"' >src/burnish/image/good.cpp
    echo '#include <embree3/rtcore.h>' >src/burnish/paths/good.cpp
    echo '#include <tbb/parallel_for.h>' >src/burnish/core/parallel.cpp
    echo '#include <CLI/CLI.hpp>' >src/burnish/app/good.cpp
    if ! check "$tree"; then
        echo "check_layers: the self-test found a violation in a clean tree" >&2
        return 1
    fi
    printf '#include <vector>\n#include "burnish/image/image.h"\n' >src/burnish/core/upward.cpp
    echo '#include "burnish/shading/bsdf.h"' >src/burnish/mitsuba/sideways.cpp
    echo '  #  include <tbb/parallel_for.h>' >src/burnish/core/threads.cpp
    echo '#include <embree4/rtcore.h>' >src/burnish/app/rays.cpp
    echo '#include <nlohmann/json.hpp>' >src/burnish/image/json.cpp
    echo '#include "burnish/shading/bsdf.h"' >scenes/light.cpp
    echo '#include "near.h"' >src/burnish/shading/unrooted.cpp
    expected='scenes/light.cpp:1
src/burnish/app/rays.cpp:1
src/burnish/core/threads.cpp:1
src/burnish/core/upward.cpp:2
src/burnish/image/json.cpp:1
src/burnish/mitsuba/sideways.cpp:1
src/burnish/shading/unrooted.cpp:1'
    found=$(bash "$script" --root "$tree" | cut -d: -f1,2 || true)
    if [ "$found" != "$expected" ]; then
        printf 'check_layers: the self-test expected\n%s\nand found\n%s\n' "$expected" "$found" >&2
        return 1
    fi
    if bash "$script" --root "$tree" >/dev/null; then
        echo "check_layers: the self-test found violations but the exit status is 0" >&2
        return 1
    fi
    echo "check_layers: self-test passed: 7 seeded violations found"
}

case "${1:-}" in
    --self-test) self_test ;;
    --root) check "$2" ;;
    '') check "$(dirname "$script")/.." && echo "check_layers: every file keeps to its layer" ;;
    *) echo "usage: check_layers.sh [--self-test]" >&2; exit 2 ;;
esac
