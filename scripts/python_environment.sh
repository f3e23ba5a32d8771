#!/usr/bin/env bash
# Prints a Python with what the Python package is built and tested with (tests/python/requirements.txt): that of a virtual
# environment in build/python_environment, which it makes where it is missing or of another Python. Prints nothing, and says
# why, where it cannot.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

environment=build/python_environment
requirements=tests/python/requirements.txt
done_mark=$environment/made_of.txt

refuse() {
    printf 'python_environment: %s; the Python package is not built\n' "$*" >&2
    exit 0
}

# The requirements, and the Python, whose next minor version has other folders for packages.
wanted=$(cat "$requirements" && python3 -c 'import sys; print("python %d.%d" % sys.version_info[:2])') || wanted=
if [ -z "$wanted" ] || [ "$wanted" != "$(cat "$done_mark" 2>/dev/null)" ]; then
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' || refuse "python3 is not there, or older than 3.10"
    echo "python_environment: installing $(tr '\n' ' ' <"$requirements")into $environment" >&2
    { python3 -m venv --clear "$environment" && "$environment/bin/pip" install -q -r "$requirements"; } >&2 ||
        refuse "pip could not install them (see above)"
    printf '%s\n' "$wanted" >"$done_mark"
fi
echo "$PWD/$environment/bin/python"
