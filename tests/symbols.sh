#!/bin/sh
# Every plugin exports its entry and nothing else, and needs nothing but the C library and libm.
set -eu
: "${top_builddir:=$(pwd)}"
case ${SPH_SANITIZED:-} in ?*) echo "instrumented: symbols of the sanitizer's own"; exit 77 ;; esac
status=0
count=0
for plugin in "$top_builddir"/plugins/.libs/*.so; do
    count=$((count + 1))
    exported=$(nm -D --defined-only "$plugin" | awk '{ print $NF }' | sort | tr '\n' ' ')
    if [ "$exported" != 'sph_plugin_entry ' ]; then
        echo "$plugin exports: $exported"
        status=1
    fi
    needed=$(readelf -d "$plugin" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
    for library in $needed; do
        case $library in
        libc.so.* | libm.so.* | ld-linux* | libmvec.so.*) ;;
        *) echo "$plugin needs $library"; status=1 ;;
        esac
    done
    if ! readelf -d "$plugin" | grep -q 'NOW'; then
        echo "$plugin is not linked with -z now"
        status=1
    fi
done
[ $count -gt 0 ] || { echo 'no plugin was built'; exit 1; }
[ $status -ne 0 ] || echo "$count plugins"
exit $status
