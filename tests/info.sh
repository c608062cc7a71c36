#!/bin/sh
# `sph info`: fits 80 columns, knows every plugin that was built, and its JSON is JSON; the command
# line says what is wrong with it, and exits as documented.
set -eu
: "${SPH:?}" "${SPH_PLUGIN_PATH:?}" "${PYTHON:?}" "${top_builddir:?}"
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
    assert item["id"].endswith("/" + item["name"]) and item["version"] and item["file"], item
    if item["kind"] in ("function", "equation of state"):
        assert item["backends"] == ["cpu", "opencl"], item
    for parameter in item["parameters"]:
        assert {"name", "unit", "doc", "default"} <= parameter.keys(), parameter
    for prop in item["properties"]:
        assert prop["access"] and prop["type"] != "?", prop
        assert all(word == word.strip() for word in prop["access"]), prop
END

# All that is declared is told by the pages of all plugins: every word of the JSON is in the text.
"$PYTHON" - "$scratch/json" "$scratch/all" <<'END' || fail 'the pages leave something out'
import json, sys
info = json.load(open(sys.argv[1]))
text = " ".join(open(sys.argv[2]).read().split())
for item in info["items"]:
    for thing in [item] + item["parameters"] + item["properties"]:
        for key in ("name", "doc", "source", "unit", "type"):
            word = str(thing.get(key, ""))
            if key == "type" and "access" not in thing:
                continue  # a parameter's is told by its range
            assert " ".join(word.split()) in text, (item["name"], key, word)
    for parameter in item["parameters"]:
        for word in parameter.get("choices", []):
            assert word in text, (item["name"], word)
for plugin in info["plugins"]:
    assert plugin["file"] in text and plugin["license"] in text, plugin
END

# KIND/NAME picks one; a name alone all that have it.
"$SPH" info scheme/gsph >"$scratch/one"
grep -q '^gsph: scheme, of plugin gsph' "$scratch/one" || fail 'info scheme/gsph: no scheme'
grep -qF "  File          $SPH_PLUGIN_PATH/gsph.so" "$scratch/one" || fail 'info scheme/gsph: no file'
[ "$(grep -c '^[a-z]' "$scratch/one")" -eq 1 ] || fail 'info scheme/gsph: more than the scheme'
"$SPH" info plugin/gsph >"$scratch/one"
grep -q '^gsph-rates: function' "$scratch/one" || fail 'info plugin/gsph: without its items'
"$SPH" info "$SPH_PLUGIN_PATH/gsph.so" | cmp -s - "$scratch/one" || fail 'info by path: not the same'
"$SPH" info --extensions | grep -q '^sph\.' || fail 'no extensions'

# What none of ours declares.
telling=$top_builddir/tests/abi/.libs/telling.so
"$SPH" info "$telling" >"$scratch/one" || fail "info telling.so: $?"
while read -r line; do
    tr -s ' \n' ' ' <"$scratch/one" | grep -qF -- "$line" || fail "info telling.so: does not say: $line"
done <<'END'
speed default 2 [m/s]: how fast
path optional table: columns t and x
map mandatory table: columns a, b
gone int32; write: not 0: away with it
made int32; write, work: copies
Dimensions 2
Removes particles where gone is not 0
Creates as many particles as made says
State kept in a checkpoint, format 7
Steps finish: tell, on what it bounds
evaluate: tell, after eos
evaluate: tell, before tell
END
"$SPH" info --json "$telling" >"$scratch/json-telling"
"$PYTHON" - "$scratch/json-telling" <<'END' || fail 'the JSON of telling.so is wrong'
import json, sys
tell, gate = json.load(open(sys.argv[1]))["items"]
assert [p["type"] for p in tell["parameters"]] == ["number", "table", "table"], tell
assert [p.get("mandatory") for p in tell["parameters"]] == [None, False, True], tell
assert (tell["remove"], tell["create"], tell["state_format"]) == ("gone", "made", 7), tell
assert tell["properties"][1]["access"] == ["write", "work"], tell
assert [s.get("on") for s in gate["steps"]] == ["bounded", None, None], gate
assert [(s.get("after"), s.get("before")) for s in gate["steps"]][1:] == [("eos", None), (None, "tell")]
END

# exists CODE ARGUMENT...: nothing is printed
exists() {
    code=$1 got=0
    shift
    "$SPH" info --exists "$@" >"$scratch/out" 2>"$scratch/err" || got=$?
    [ $got -eq "$code" ] || fail "sph info --exists $*: exit code $got, not $code"
    [ ! -s "$scratch/out" ] || fail "sph info --exists $*: prints something"
    [ $got -eq 2 ] || [ ! -s "$scratch/err" ] || fail "sph info --exists $*: complains"
}
version=$("$PYTHON" -c 'import json, sys
print(next(p["version"] for p in json.load(open(sys.argv[1]))["plugins"] if p["name"] == "gsph"))' "$scratch/json")
for id in gsph gsph.so plugin/gsph scheme/gsph gsph-rates function/gsph-rates kernel/wendland-c4 \
    eos/ideal-gas exact/noh; do
    exists 0 $id
    exists 0 $id --atleast "$version"
    exists 0 $id --atleast 0
    exists 1 $id --atleast "$version.1"
    exists 1 $id --atleast 99999999999999999999999.0
done
exists 0 gsph --atleast "$version.0.0"
exists 0 gsph --atleast "00$version"
for id in no-such kernel/gsph plugin/gsph-rates boundary/noh gsp; do exists 1 $id; done
exists 1 no-such --atleast 0
exists 0 gate --load "$telling" --atleast 0.9
exists 0 gate --load "$telling" --atleast 0.10.2
exists 1 gate --load "$telling" --atleast 0.11
exists 2 no-kind/gsph
exists 2 "$SPH_PLUGIN_PATH/gsph.so"
exists 2 ''
for version in x 1.x 1..2 .1 1. -1 '' '1 '; do exists 2 gsph --atleast "$version"; done
exists 2 gsph noh
for option in --json --build --devices --extensions; do exists 2 gsph $option; done
says 2 '--atleast goes with --exists' info --atleast 1

says 0 'plugin ABI' --version
says 0 'Usage: sph' --help
says 0 'HDF5' info --build
says 2 'did you mean "info"' inof
says 2 'did you mean "kernels"' info kernel
says 2 'no plugin or item "kernel/wendland-c5" (did you mean "wendland-c2"?)' info kernel/wendland-c5
says 2 'known are: barotropic, ' info scheme/wendland-c4
says 2 'no scene is given'
says 3 'no plugin "no-such-plugin"' info --load no-such-plugin
cp "$0" "$scratch/script.so"
chmod 644 "$scratch/script.so"
says 3 "it is not an ELF file" info --load "$scratch/script.so"
exit $status
