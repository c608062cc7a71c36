#!/bin/sh
# The dependency rule: plugins -> sdk <- core.
#   - a plugin includes headers of the SDK, of its own folder and of the system, no others;
#   - the SDK includes itself and the system;
#   - nothing under core/ includes a plugin's file or names a physics scheme, not in a comment either.
# The rule is first applied to copies that break it: a checker that cannot fail proves nothing.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/.." && pwd)}"

# Schemes, solvers and test problems by name. The names of plugins are added, but for those that are
# words of the ABI, where a kernel, an equation of state or an exact solution is a kind the core knows,
# or of every day (forces).
names='gsph|mpm|adke|wcsph|crksph|edac|tvf|godunov|riemann|hllc|inutsuka|balsara|noh|sod'
names="$names|sedov|gresho|taylor-green|dam-break|poiseuille|couette|wendland|gaussian|cubic-spline"
names="$names|ideal-gas|tait|artificial[- ]viscosity"
kinds=' eos exact kernels boundaries forces '

# complaints ROOT: one line for every breach under ROOT.
complaints() {
    root=$1
    words=$names
    for folder in "$root"/plugins/*/; do
        name=$(basename "$folder")
        case $kinds in *" $name "*) ;; *) words="$words|$name" ;; esac
    done
    grep -rniE "(^|[^a-z])($words)([^a-z]|\$)" "$root/core" --include='*.[ch]' --include='*.am' |
        sed "s|^$root/|names physics: |" || :

    find "$root/core" "$root/sdk" "$root/plugins" -name '*.[ch]' | while read -r file; do
        sed -n 's/^[ \t]*#[ \t]*include[ \t]*\([<"][^>"]*\)[>"].*/\1/p' "$file" |
            while read -r include; do
                path=${include#?}
                breach=
                case ${file#"$root"/} in
                sdk/*)
                    case $include in
                    '<sph/'*) [ -f "$root/sdk/$path" ] || breach='is not in the SDK' ;;
                    '"'*) breach='is quoted: a header of the SDK is <sph/...>' ;;
                    *) [ ! -e "$root/core/$path" ] || breach='is the core'"'"'s' ;;
                    esac ;;
                plugins/*)
                    case $include in
                    '<sph/'*) [ -f "$root/sdk/$path" ] || breach='is not in the SDK' ;;
                    *..*) breach='leaves the plugin' ;;
                    '"'*) [ -f "$(dirname "$file")/$path" ] || breach='is not in the plugin' ;;
                    *) [ ! -e "$root/core/$path" ] || breach='is the core'"'"'s' ;;
                    esac ;;
                core/*)
                    case $include in
                    '<sph/'*) [ -f "$root/sdk/$path" ] || breach='is not in the SDK' ;;
                    *plugins/*) breach='is a plugin'"'"'s' ;;
                    '"'*..*) breach='climbs: name it from core/' ;;
                    esac ;;
                esac
                [ -z "$breach" ] || echo "includes: ${file#"$root"/}: $path $breach"
            done
    done
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# poison FILE LINE: appended to FILE in a copy of the sources, LINE must be complained of.
poison() {
    rm -rf "$scratch/tree"
    mkdir "$scratch/tree"
    cp -R "$top_srcdir/core" "$top_srcdir/sdk" "$top_srcdir/plugins" "$scratch/tree"
    chmod -R u+w "$scratch/tree"
    printf '%s\n' "$2" >>"$scratch/tree/$1"
    if [ "$(complaints "$scratch/tree" | wc -l)" -le "$clean" ]; then
        echo "not noticed in $1: $2"
        exit 1
    fi
}

complaints "$top_srcdir" >"$scratch/found"
clean=$(wc -l <"$scratch/found")
plugin=$(cd "$top_srcdir" && find plugins -name '*.c' | sort | sed 1q)
core=$(cd "$top_srcdir" && find core -name '*.c' | sort | sed 1q)
header=$(cd "$top_srcdir/core" && find . -name '*.h' | sort | sed '1q' | sed 's|^\./||')

poison "$plugin" "#include \"$header\""
poison "$plugin" "#include <$header>"
poison "$plugin" "#include \"../../core/$header\""
poison "$plugin" '#include <sph/no-such-header.h>'
poison sdk/sph/abi.h "#include <$header>"
poison sdk/sph/abi.h '#include "local.h"'
poison "$core" '#include "plugins/gsph/gsph.h"'
poison "$core" '#include <sph/no-such-header.h>'
poison "$core" "/* as gsph does */"
poison "$core" '    if (strcmp(name, "Riemann") == 0)'
poison core/fragment.am '# for Noh'

if [ -s "$scratch/found" ]; then
    cat "$scratch/found"
    exit 1
fi
echo 'the rule holds, and its breaches would be noticed'
