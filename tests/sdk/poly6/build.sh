#!/bin/sh
# Builds poly6.so with nothing but a compiler and pkg-config. The pair body is found by -iquote.
set -eu
cd "$(dirname "$0")"
ask() { pkg-config "$@" sph-plugin; }
# shellcheck disable=SC2046 # words are meant
${CC:-cc} $(ask --cflags) -iquote . $(ask --variable=plugin_cflags) -g \
    $(ask --variable=plugin_ldflags) -o poly6.so poly6.c $(ask --variable=plugin_libs)
chmod go-w poly6.so
