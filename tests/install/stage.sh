# stage.sh -- gives a test an installed tree of its own, to be read by a shell script:
#
#   . "$top_srcdir/tests/install/stage.sh"
#   stage                    installs with DESTDIR, then moves the tree to another prefix
#
# sets
#   $stage_dir               a temporary folder, removed when the script ends; yours to use
#   $stage_prefix            the prefix of the tree, $stage_dir/prefix (bin, lib, share ...)
#   PATH, PKG_CONFIG_PATH, ACLOCAL_PATH   so that sph, pkg-config sph-plugin and aclocal find it
#   HOME, XDG_DATA_HOME      folders in $stage_dir: the user's own plugins play no part
# and takes the paths of source and build, and what the tests set for plugins, out of the environment:
# what runs afterwards has the installed tree alone. A script that traps EXIT itself ends with
# `rm -rf "$stage_dir"`. Several tests may stage at once.

stage() {
    stage_dir=$(mktemp -d)
    trap 'rm -rf "$stage_dir"' EXIT
    trap 'exit 1' HUP INT TERM
    # The loader refuses plugins that others may write to.
    umask 022
    # Not `install`, which would build first: tests that run beside each other must not.
    if ! (unset MAKEFLAGS MFLAGS MAKELEVEL GNUMAKEFLAGS MAKEOVERRIDES
        cd "$top_builddir" && make -s install-exec install-data DESTDIR="$stage_dir/dest") \
        >"$stage_dir/install.log" 2>&1; then
        cat "$stage_dir/install.log"
        echo 'stage.sh: make install failed'
        exit 1
    fi
    stage_prefix=$(cd "$top_builddir" && sed -n 's/^prefix = //p' Makefile)
    mv "$stage_dir/dest$stage_prefix" "$stage_dir/prefix"
    rm -rf "$stage_dir/dest"
    stage_prefix=$stage_dir/prefix
    stage_pc=$(find "$stage_prefix" -name sph-plugin.pc)
    PATH=$stage_prefix/bin:$PATH
    PKG_CONFIG_PATH=$(dirname "$stage_pc")
    ACLOCAL_PATH=$stage_prefix/share/aclocal
    HOME=$stage_dir/home
    XDG_DATA_HOME=$HOME/.local/share
    mkdir -p "$XDG_DATA_HOME"
    export PATH PKG_CONFIG_PATH ACLOCAL_PATH HOME XDG_DATA_HOME
    unset SPH SPH_PLUGIN_PATH SPH_DATA_PATH top_srcdir top_builddir
    unset CORE_CPPFLAGS CORE_CFLAGS PLUGIN_CPPFLAGS PLUGIN_CFLAGS CMOCKA_CFLAGS
    unset MAKEFLAGS MFLAGS MAKELEVEL GNUMAKEFLAGS MAKEOVERRIDES
}
