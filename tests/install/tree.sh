#!/bin/sh
# Installation: into a DESTDIR and into a prefix of its own; the program finds its plugins and its
# data there without a word from the environment, also after the tree was moved; uninstall leaves
# nothing behind.
set -eu
: "${top_srcdir:?}" "${top_builddir:?}" "${PYTHON:?}" "${CC:?}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
umask 022
status=0
plugins=$(cd "$top_builddir/plugins/.libs" && ls ./*.so | sed 's|^\./||; s/\.so$//')
unset SPH_PLUGIN_PATH SPH
mkdir "$scratch/home"
HOME=$scratch/home XDG_DATA_HOME=
export HOME XDG_DATA_HOME

fail() { echo "$*"; status=1; }

# Not `make install`, which builds first: tests run beside each other.
in_build() {
    (unset MAKEFLAGS MFLAGS MAKELEVEL GNUMAKEFLAGS MAKEOVERRIDES
     cd "$top_builddir" && make -s "$@") >"$scratch/make.log" 2>&1 ||
        { cat "$scratch/make.log"; echo "make $*: failed"; exit 1; }
}

# All that is there, with kinds: f bin/sph
contents() { (cd "$1" && find . -mindepth 1 -printf '%y %P\n' | sort); }

# is_whole TREE: what a tree must hold, and must not
is_whole() {
    for file in bin/sph bin/sph-plugin-check share/bash-completion/completions/sph \
        share/bash-completion/completions/sph-plugin-check share/sph/examples/scene.schema.json; do
        [ -f "$1/$file" ] || fail "$1 lacks $file"
    done
    for file in "$top_srcdir"/man/*.[1-9]; do
        [ -f "$1/share/man/man${file##*.}/$(basename "$file")" ] || fail "$1 lacks $(basename "$file")"
    done
    for file in "$top_srcdir"/examples/*.json; do
        [ -f "$1/share/sph/examples/$(basename "$file")" ] || fail "$1 lacks $(basename "$file")"
    done
    for file in "$top_srcdir"/sdk/sph/*.h; do
        [ -f "$(echo "$1"/include/sph-*/sph)/$(basename "$file")" ] || fail "$1 lacks $file"
    done
    for name in $plugins; do
        [ "$(find "$1" -path "*/sph/plugins-*/$name.so" | wc -l)" -eq 1 ] || fail "$1 lacks $name.so"
    done
    if find "$1" -name '*.la' | grep .; then fail "$1 has libtool's files"; fi
    if find "$1" \( -type f -o -type d \) -perm /022 | grep .; then fail "others may write to these"; fi
}

# works TREE: all plugins are found, in this tree, and a scene runs
works() {
    "$1/bin/sph" info --json >"$scratch/info.json" 2>"$scratch/err" || fail "sph info in $1: $?"
    [ ! -s "$scratch/err" ] || { cat "$scratch/err"; fail "sph info in $1 complains"; }
    # shellcheck disable=SC2086 # words are meant
    "$PYTHON" - "$scratch/info.json" "$1" $plugins <<'END_OF_PYTHON' || fail "plugins in $1"
import json, os, sys
info = json.load(open(sys.argv[1]))
tree = os.path.realpath(sys.argv[2]) + "/"
assert sorted(p["name"] for p in info["plugins"]) == sorted(sys.argv[3:]), info["plugins"]
for thing in info["plugins"] + info["items"]:
    assert thing["file"].startswith(tree), thing
END_OF_PYTHON
    "$1/bin/sph" "$1/share/sph/examples/noh-1d.json" --steps 3 --quiet --out "$scratch/run" \
        >"$scratch/out" 2>&1 || { cat "$scratch/out"; fail "a scene in $1: does not run"; }
    grep -q '"steps":[[:space:]]*3' "$scratch/run/summary.json" || fail "a scene in $1: not 3 steps"
    rm -rf "$scratch/run"
    mkdir "$scratch/run"
    "$1/bin/sph" new-plugin mine --dir "$scratch/run" >"$scratch/out" 2>&1 ||
        { cat "$scratch/out"; fail "new-plugin in $1: does not find its templates"; }
    [ -f "$scratch/run/mine/mine.c" ] || fail "new-plugin in $1: no mine.c"
    rm -rf "$scratch/run"
    "$1/bin/sph-plugin-check" --quiet kernels >"$scratch/out" 2>&1 ||
        { cat "$scratch/out"; fail "sph-plugin-check in $1: does not find kernels"; }
}

# tells TREE: pkg-config finds it where it lies, and follows another prefix
tells() {
    PKG_CONFIG_PATH=$(dirname "$(find "$1" -name sph-plugin.pc)")
    export PKG_CONFIG_PATH
    is_same "$(pkg-config --variable=pluginsdir sph-plugin)" "$(dirname "$(find "$1" -name eos.so)")"
    "$1/bin/sph" --version | grep -qF "ABI $(pkg-config --variable=abi_version sph-plugin))" ||
        fail "abi_version is $(pkg-config --variable=abi_version sph-plugin)"
    case $(pkg-config --define-variable=prefix=/else/where --variable=pluginsdir sph-plugin) in
    /else/where/*/sph/plugins-"$(pkg-config --variable=abi_version sph-plugin | cut -d. -f1)") ;;
    *) fail 'pluginsdir does not follow prefix' ;;
    esac
    echo '#include <sph/plugin.h>' >"$scratch/one.c"
    # shellcheck disable=SC2046 # words are meant
    $CC $(pkg-config --cflags sph-plugin) -fsyntax-only "$scratch/one.c" || fail "headers in $1"
}
is_same() { [ "$(realpath "$1")" = "$(realpath "$2")" ] || fail "$1 is not $2"; }

# -- DESTDIR, as for a package
prefix=$(sed -n 's/^prefix = //p' "$top_builddir/Makefile")
in_build install-exec install-data DESTDIR="$scratch/dest"
is_whole "$scratch/dest$prefix"
works "$scratch/dest$prefix"
contents "$scratch/dest$prefix" >"$scratch/installed"
pkgconfig=$(dirname "$(sed -n 's|^f \(.*/sph-plugin.pc\)$|\1|p' "$scratch/installed")")
# What is packed is what is unpacked elsewhere.
mkdir "$scratch/other"
cp -R "$scratch/dest$prefix" "$scratch/other/place"
in_build uninstall DESTDIR="$scratch/dest"
if find "$scratch/dest" ! -type d | grep .; then fail 'uninstall leaves these files'; fi
if find "$scratch/dest$prefix" -mindepth 1 -type d -name '*sph*' | grep .; then fail 'and these folders'; fi
works "$scratch/other/place"
tells "$scratch/other/place"

# -- A prefix that others use as well
mine=$scratch/mine
for folder in bin include "$pkgconfig" share/aclocal share/bash-completion/completions \
    share/man/man1 share/man/man5 share/man/man7; do mkdir -p "$mine/$folder"; done
echo 'not ours' >"$mine/bin/tool"
contents "$mine" >"$scratch/before"
in_build install-exec install-data prefix="$mine"
is_whole "$mine"
works "$mine"
tells "$mine"
contents "$mine" >"$scratch/after"
grep -v ' bin/tool$' "$scratch/after" | comm -23 - "$scratch/before" >"$scratch/new"
comm -13 "$scratch/installed" "$scratch/new" | grep . && fail 'DESTDIR did not have these'
mv "$mine" "$scratch/moved"
works "$scratch/moved"
tells "$scratch/moved"
ln -s "$scratch/moved/bin/sph" "$scratch/home/sph"
"$scratch/home/sph" info --exists kernel/wendland-c4 || fail 'through a symbolic link: no plugins'
mv "$scratch/moved" "$mine"
# A plugin of somebody else keeps its folder, no more.
folder=$(dirname "$(find "$mine" -name eos.so)")
cp "$folder/eos.so" "$folder/theirs.so"
in_build uninstall prefix="$mine"
[ -f "$folder/theirs.so" ] || fail "uninstall removes the plugins of others"
rm "$folder/theirs.so"
in_build uninstall prefix="$mine"
contents "$mine" >"$scratch/after"
diff "$scratch/before" "$scratch/after" || fail 'uninstall leaves these (>), or took these (<)'

# -- Other layouts: what place.c finds, in a program that only asks
cat >"$scratch/ask.c" <<'END_OF_C'
#include "base/place.h"
#include <stdio.h>
int main(void) { return printf("%s\n%s\n", place_plugins(), place_data()) < 0; }
END_OF_C
for lib in lib lib64 lib/x86_64-linux-gnu; do
    tree=$scratch/layout/$lib/tree
    mkdir -p "$tree/bin" "$tree/$lib/sph/plugins-0" "$tree/share/sph"
    $CC -D_GNU_SOURCE -DSPH_BINDIR='"/opt/sph/bin"' -DSPH_PLUGINDIR="\"/opt/sph/$lib/sph/plugins-0\"" \
        -DSPH_DATADIR='"/opt/sph/share/sph"' -I"$top_builddir" -I"$top_srcdir/core" \
        -o "$tree/bin/ask" "$scratch/ask.c" "$top_srcdir/core/base/place.c" \
        "$top_srcdir/core/base/text.c"
    printf '%s\n' "$tree/$lib/sph/plugins-0" "$tree/share/sph" >"$scratch/expected"
    (cd / && "$tree/bin/ask") | diff "$scratch/expected" - || fail "$lib: not found"
    rmdir "$tree/share/sph"
    "$tree/bin/ask" | grep -qx /opt/sph/share/sph || fail "$lib: falls back to no folder"
done
exit $status
