#!/bin/sh
# The SDK's headers, alone and twice, are clean C99 to C17 and C++11 to C++20 for gcc and clang. Two
# plugins, one that is C and C++ at once and has a pair loop, one that is C++, load and export one
# symbol.
set -eu
: "${top_srcdir:?}" "${SPH:?}"
umask 022
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
XDG_DATA_HOME=$scratch
export XDG_DATA_HOME
status=0
warn='-pedantic -Werror -Wall -Wextra -Wshadow'
link='-shared -fPIC -O2 -fno-math-errno -fvisibility=hidden -Wl,-z,defs -Wl,-z,now'
link="$link -Wl,--version-script=$top_srcdir/sdk/sph-plugin.map"
abi=$top_srcdir/tests/abi

# clean WHAT COMPILER FLAG...: compiles without a word.
clean() {
    what=$1
    shift
    if ! "$@" >"$scratch/said" 2>&1 || [ -s "$scratch/said" ]; then
        echo "$what, by $*:"
        sed 10q "$scratch/said"
        status=1
    fi
}

# knows COMPILER LANGUAGE: is that one here?
knows() {
    command -v "$1" >/dev/null && echo 'int main(void) { return 0; }' |
        "$1" -x "$2" -fsyntax-only - >/dev/null 2>&1
}

# all COMPILER LANGUAGE STANDARD: every header, and the sources that this standard can read.
all() {
    flags="-x $2 -std=$3 $warn -fsyntax-only -nostdlib -I$top_srcdir/sdk -I$abi"
    [ "$2" != c ] || flags="$flags -Wstrict-prototypes -Wmissing-prototypes"
    for header in "$top_srcdir"/sdk/sph/*.h; do
        name=sph/${header##*/}
        case $3/$name in
        # The insides of pair-loop.h and point-loop.h, and those, which want a body: see both.c.
        */lanes*.h | */each-isa.h | */pair-*.h | */point-*.h | gnu*) continue ;;
        esac
        printf '#include <%s>\n#include <%s>\nint main(void) { return 0; }\n' "$name" "$name" \
            >"$scratch/alone.$2"
        # shellcheck disable=SC2086 # a list of words
        clean "$name" "$1" $flags "$scratch/alone.$2"
        headers=$((headers + 1))
    done
    # shellcheck disable=SC2086
    clean both.c "$1" $flags "$abi/both.c"
    [ "$2" = c ] || clean plugin.cc "$1" $flags "$abi/plugin.cc"
}

# loads COMPILER LANGUAGE SOURCE ITEM: built as its users would, it registers, and exports its entry
# alone.
loads() {
    # shellcheck disable=SC2086
    clean "$3" "$1" -x "$2" $warn -I"$top_srcdir/sdk" -I"$abi" "$abi/$3" $link \
        -o "$scratch/plugin.so" -lm
    "$SPH" info --load "$scratch/plugin.so" >"$scratch/info" 2>&1 ||
        { echo "$3, built by $1 as $2, is refused:"; tail -n 3 "$scratch/info"; status=1; }
    grep -q "$4" "$scratch/info" || { echo "$3, built by $1 as $2, has no $4"; status=1; }
    exported=$(nm -D --defined-only "$scratch/plugin.so" | awk '{ print $NF }' | tr '\n' ' ')
    [ "$exported" = 'sph_plugin_entry ' ] ||
        { echo "$3, built by $1, exports: $exported"; status=1; }
}

tried=0
headers=0
for compiler in gcc clang; do
    for language in c c++; do
        knows $compiler $language ||
            { echo "no $compiler for $language here: not tried"; continue; }
        tried=$((tried + 1))
        case $language in
        c) standards='c99 c11 c17 gnu99 gnu11 gnu17' ;;
        c++) standards='c++11 c++14 c++17 c++20 gnu++11 gnu++20' ;;
        esac
        for standard in $standards; do all $compiler $language $standard; done
    done
done
[ $tried -gt 0 ] || exit 77

# The checker itself: a header that is no C++ is noticed.
echo '#include <sph/abi.h>
static inline uint32_t sph_first(const void *p) { const uint32_t *q = p; return *q; }
int main(void) { return 0; }' >"$scratch/poor.c"
# shellcheck disable=SC2086
if (status=0; clean poor gcc -x c++ $warn -fsyntax-only -I"$top_srcdir/sdk" "$scratch/poor.c" \
    >/dev/null; exit $status); then
    echo 'a header that is no C++ went unnoticed'
    status=1
fi

for compiler in gcc g++ clang clang++; do
    case $compiler in *++) language=c++ ;; *) language=c ;; esac
    knows $compiler $language || continue
    loads $compiler $language both.c neighbours
    [ $language = c ] || loads $compiler $language plugin.cc 'cold-gas'
done
[ $status -ne 0 ] || echo "$headers times a header, alone: clean"
exit $status
