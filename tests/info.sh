#!/bin/sh
# `sph info`: fits 80 columns, knows every plugin that was built, and its JSON is JSON; the command
# line says what is wrong with it, and exits as documented.
set -eu
: "${SPH:?}" "${SPH_PLUGIN_PATH:?}" "${PYTHON:?}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
XDG_DATA_HOME=$scratch
export XDG_DATA_HOME
status=0

fail() { echo "$*"; status=1; }

# says CODE TEXT ARGUMENT...: the exit code, and a text in one line of stderr
says() {
    code=$1 text=$2
    shift 2
    got=0
    "$SPH" "$@" >"$scratch/out" 2>"$scratch/err" || got=$?
    [ $got -eq "$code" ] || fail "sph $*: exit code $got, not $code"
    grep -qF -- "$text" "$scratch/out" "$scratch/err" || fail "sph $*: does not say: $text"
}

"$SPH" info >"$scratch/all"
for plugin in "$SPH_PLUGIN_PATH"/*.so; do
    name=$(basename "$plugin" .so)
    "$SPH" info "$name" >"$scratch/one" || fail "sph info $name: $?"
    cat "$scratch/one" >>"$scratch/all"
done
# Paths and digital object identifiers cannot be broken.
if grep -vE '(/|doi:)' "$scratch/all" | grep -E '.{81}'; then fail 'wider than 80 columns'; fi

"$SPH" info --json >"$scratch/json"
"$PYTHON" - "$scratch/json" <<'END' || fail 'the JSON is wrong'
import json, sys
info = json.load(open(sys.argv[1]))
plugins = {p["name"] for p in info["plugins"]}
assert plugins, "no plugin"
for item in info["items"]:
    assert item["plugin"] in plugins and item["doc"] and item["dimensions"], item
    for parameter in item["parameters"]:
        assert {"name", "unit", "doc", "default"} <= parameter.keys(), parameter
    for prop in item["properties"]:
        assert prop["access"] and prop["type"] != "?", prop
        assert all(word == word.strip() for word in prop["access"]), prop
END

says 0 'plugin ABI' --version
says 0 'Usage: sph' --help
says 0 'HDF5' info --build
says 2 'did you mean "info"' inof
says 2 'did you mean "kernels"' info kernel
says 2 'no scene is given'
says 3 'no plugin "no-such-plugin"' info --load no-such-plugin
cp "$0" "$scratch/script.so"
chmod 644 "$scratch/script.so"
says 3 "it is not an ELF file" info --load "$scratch/script.so"
exit $status
