#!/bin/sh
# The sources are formatted as .clang-format says. Other versions of clang-format differ in detail:
# skipped where version 14 is not installed.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/.." && pwd)}"
tool=$(command -v clang-format-14 || command -v clang-format) || { echo 'no clang-format'; exit 77; }
"$tool" --version | grep -q 'version 14\.' || { echo "not version 14: $("$tool" --version)"; exit 77; }
cd "$top_srcdir"
[ -f .clang-format ]
status=0
for file in $(find core plugins sdk tests -name '*.[ch]' | sort); do
    "$tool" "$file" | cmp -s - "$file" || { echo "not formatted (make format does it): $file"; status=1; }
done
exit $status
