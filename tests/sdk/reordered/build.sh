#!/bin/sh
# Builds reordered.so with nothing but a compiler and pkg-config.
set -eu
cd "$(dirname "$0")"
ask() { pkg-config "$@" sph-plugin; }
# shellcheck disable=SC2046 # words are meant
${CC:-cc} $(ask --cflags) $(ask --variable=plugin_cflags) -g $(ask --variable=plugin_ldflags) \
    -o reordered.so reordered.c $(ask --variable=plugin_libs)
chmod go-w reordered.so
