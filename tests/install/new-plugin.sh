#!/bin/sh
# `sph new-plugin` from an installed tree alone: a project of each kind builds, passes its own test,
# is packed, built again from its tarball, installed and uninstalled; by make with gcc, clang and C++,
# and by autotools. Its module exports one symbol and needs no library of ours. What cannot be made is
# refused, and nothing is left.
set -eu
: "${top_srcdir:=$(cd "$(dirname "$0")/../.." && pwd)}"
: "${top_builddir:=$(pwd)}"
. "$top_srcdir/tests/install/stage.sh"
stage
cd "$stage_dir"
mkdir work
cd work
log=$stage_dir/log
pluginsdir=$(pkg-config --variable=pluginsdir sph-plugin)
pluginsdir=$(cd "$pluginsdir" && pwd -P)
fail() {
    echo "MISS $*"
    exit 1
}

# quietly WHAT COMMAND...: what it says is shown if it fails.
quietly() {
    what=$1
    shift
    "$@" >"$log" 2>&1 || { cat "$log"; fail "$what"; }
}

# one_symbol MODULE
one_symbol() {
    exported=$(nm -D --defined-only "$1" | awk '{ print $NF }' | tr '\n' ' ')
    [ "$exported" = 'sph_plugin_entry ' ] || fail "$1 exports: $exported"
    ldd "$1" | while read -r library rest; do
        case $library in
        statically | linux-vdso* | */ld-linux* | libc.so* | libm.so* | libstdc++.so* | libgcc_s.so*) ;;
        *) fail "$1 needs $library $rest" ;;
        esac
    done || exit 1
}

# installs FOLDER MODULE: make install puts the module where sph looks, make uninstall takes it away.
installs() {
    quietly "$1: make install DESTDIR" make -s -C "$1" install DESTDIR="$stage_dir/root"
    [ -f "$stage_dir/root$pluginsdir/$2" ] || fail "$1: DESTDIR$pluginsdir/$2 is not there"
    quietly "$1: make uninstall DESTDIR" make -s -C "$1" uninstall DESTDIR="$stage_dir/root"
    left=$(find "$stage_dir/root" ! -type d)
    [ -z "$left" ] || fail "$1: uninstall leaves $left"
    rm -rf "$stage_dir/root"
}

# -- Each kind, by make --------------------------------------------------------------------------

for kind in function eos boundary kernel scheme exact; do
    name=my-own-$kind
    quietly "$kind: new-plugin" sph new-plugin "$name" --kind "$kind"
    if grep -rniE 'my[-_]plugin|@[A-Z]+@' "$name" || find "$name" -name '*my-plugin*' | grep .; then
        fail "$kind: a word of the template is left"
    fi
    cc=gcc
    [ $kind != function ] || ! command -v clang >/dev/null || cc=clang
    # The scheme's loops take long to optimise.
    optimise=
    [ $kind != scheme ] || optimise=-O1
    quietly "$kind: make check" make -s -C "$name" check CC=$cc \
        CFLAGS="$optimise -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror"
    cat "$log"
    grep -q '^PASS: ./test.py' "$log" || fail "$kind: its test did not run"
    one_symbol "$name/$name.so"
    quietly "$kind: make dist" make -s -C "$name" dist
    mkdir again
    tar -xzf "$name/$name-0.1.tar.gz" -C again
    quietly "$kind: build of the tarball" make -s -C "again/$name-0.1" CFLAGS=-O0
    for file in .gitignore LICENSE README.md scene.json; do
        cmp "$name/$file" "again/$name-0.1/$file" || fail "$kind: the tarball lacks $file"
    done
    rm -rf again
    installs "$name" "$name.so"
done

# -- Where sph finds it --------------------------------------------------------------------------

quietly 'install' make -s -C my-own-kernel install
quietly 'sph info' sph info kernel/my-own-kernel
quietly 'uninstall' make -s -C my-own-kernel uninstall
if sph info --exists kernel/my-own-kernel; then fail 'uninstalled, and still there'; fi
quietly 'install-user' make -s -C my-own-kernel install-user
quietly 'sph info' sph info kernel/my-own-kernel
quietly 'uninstall-user' make -s -C my-own-kernel uninstall-user
if sph info --exists kernel/my-own-kernel; then fail 'uninstalled by the user, and still there'; fi

# -- Only what is needed is made again -----------------------------------------------------------

# made WHAT yes|no FILE COMMAND...: does the command write FILE?
made() {
    what=$1 expected=$2 file=$3
    shift 3
    before=$(stat -c %y "$file")
    quietly "$what" "$@"
    found=yes
    [ "$before" != "$(stat -c %y "$file")" ] || found=no
    [ $found = "$expected" ] || fail "$what: is $file made again? $found"
}
cd my-own-kernel
quietly 'all' make -s
made 'nothing changed' no my-own-kernel.so make -s
made 'installed with another flag' no my-own-kernel.so make -s install CFLAGS=-O1 DESTDIR="$PWD/build"
made 'a flag changed' yes my-own-kernel.so make -s CFLAGS=-O1
touch my-own-kernel.c
made 'a source changed' yes my-own-kernel.so make -s CFLAGS=-O1
quietly 'clean' make -s clean
quietly 'distcheck' make -s distcheck
quietly 'clean' make -s clean
files='.gitignore LICENSE Makefile README.md my-own-kernel.c runs.py scene.json test.py '
[ "$(ls -A | tr '\n' ' ')" = "$files" ] || fail "clean leaves $(ls -A)"
cd ..

# -- Other ways to build -------------------------------------------------------------------------

# C++, whose library would export symbols of its own.
echo '#include <vector>
int f(int n) { std::vector<int> v(n); return v.at(0); }' >t.cc
if g++ -shared -fPIC t.cc -o t.so 2>/dev/null; then
    cp -R my-own-eos plus
    cd plus
    { cat my-own-eos.c; echo '#include <vector>
std::vector<double> sph_many(4);'; } >my-own-eos.cc
    sed -i 's/my-own-eos\.c$/my-own-eos.cc/' Makefile
    quietly 'C++' make -s check
    one_symbol my-own-eos.so
    cd ..
fi
# A tree that is not where its prefix says, as for another machine.
mkdir -p sysroot/usr
cp -R "$stage_prefix" sysroot/usr/local
(
    PKG_CONFIG_SYSROOT_DIR=$PWD/sysroot
    PKG_CONFIG_PATH=$PWD/sysroot/usr/local/lib/pkgconfig
    export PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_PATH
    quietly 'sysroot' make -s -C my-own-eos clean check
) || exit 1

# Autotools.
quietly 'autotools: new-plugin' sph new-plugin my-auto --dir . --build autotools
cd my-auto
quietly 'autoreconf' autoreconf -fi
mkdir build
cd build
quietly 'configure' ../configure
quietly 'make' make -s
one_symbol .libs/my-auto.so
quietly 'make distcheck' make -s distcheck
cd ..
installs build my-auto.so
cd ..

# -- Refusals ------------------------------------------------------------------------------------

# refused SENTENCE ARGUMENT...
refused() {
    sentence=$1
    shift
    status=0
    sph new-plugin "$@" >"$log" 2>&1 || status=$?
    [ $status = 2 ] || fail "new-plugin $*: exit status $status"
    grep -qF -e "$sentence" "$log" || { cat "$log"; fail "new-plugin $*: not: $sentence"; }
}
ls -A >"$stage_dir/before"
touch file
refused 'my-own-eos is there already' my-own-eos
refused 'file is there already' file
refused '"My" is no name for a plugin' My
refused '"1st" is no name for a plugin' 1st
refused '"a/b" is no name for a plugin' a/b
refused '"" is no name for a plugin' ''
refused 'longer than 40 letters' aaaaaaaaaabbbbbbbbbbccccccccccddddddddddeeeee
refused 'did you mean "kernel"?' x --kind kernle
refused 'did you mean "make"?' x --build cmake
refused 'nowhere: No such file or directory' x --dir nowhere
refused 'file is no folder' x --dir file
refused 'the name of the plugin is missing'
refused 'one plugin at a time' x y
rm file
ls -A | cmp -s - "$stage_dir/before" || fail "something is left: $(ls -A)"
# What goes wrong half way leaves nothing either.
mkdir -p broken/templates
for part in eos common; do
    cp -R "$stage_prefix/share/sph/templates/$part" broken/templates
done
status=0
SPH_DATA_PATH=$PWD/broken sph new-plugin half --kind eos >"$log" 2>&1 || status=$?
[ $status = 1 ] || fail "a template is missing: exit status $status"
rm -r broken
[ ! -e half ] || fail 'half a project is there'
ls -A | cmp -s - "$stage_dir/before" || fail "half a project is left: $(ls -A)"
echo 'projects of every kind'
