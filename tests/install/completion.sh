#!/bin/sh
# Completion in bash: sourced, and asked as bash asks it.
set -eu
: "${top_srcdir:?}" "${SPH:?}" "${SPH_PLUGIN_PATH:?}"
command -v bash >/dev/null || { echo 'no bash here'; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin" "$scratch/here" "$scratch/here/folder" "$scratch/here/results"
ln -s "$SPH" "$scratch/bin/sph"
ln -s "$SPH-plugin-check" "$scratch/bin/sph-plugin-check"
cd "$scratch/here"
touch tube.json notes.txt 'two words.json' mine.so results/snapshot_0001.vtkhdf results/checkpoint_00000010.h5 results/log.csv

cat >"$scratch/ask.bash" <<'END_OF_BASH'
# ask WORD...: what comes of the last word, on one line, sorted. bash hands over "=" as a word.
source "$1"
status=0
ask() {
    COMP_WORDS=(sph "$@")
    COMP_CWORD=$#
    COMPREPLY=()
    _sph || echo "sph $*: the function fails"
    printf '%s\n' ${COMPREPLY[@]+"${COMPREPLY[@]}"} | sort | tr '\n' ' ' | sed 's/ $//'
}
# is EXPECTED WORD...
is() {
    expected=$1
    shift
    got=$(ask "$@")
    if [ "$got" != "$expected" ]; then echo "sph $*: \"$got\", not \"$expected\""; status=1; fi
}
# has EXPECTED WORD...: among others; hasnt: not among them
has() {
    expected=$1
    shift
    case " $(ask "$@") " in *" $expected "*) ;; *) echo "sph $*: no $expected"; status=1 ;; esac
}
hasnt() {
    expected=$1
    shift
    case " $(ask "$@") " in *" $expected "*) echo "sph $*: $expected"; status=1 ;; *) ;; esac
}
complete -p sph | grep -q -- '-F _sph' || { echo 'not set for sph'; status=1; }

# Commands and scenes
is info inf
is render ren
for command in $(sph --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do has "$command" ''; done
has tube.json ''
hasnt notes.txt ''
is tube.json tu
is 'two words.json' run tw
is 'folder/' run fo
is tube.json --quiet check tu

# Options: those of the command, and all of them
is --dry-run run --dr
is --dry-run --dr
is --version --vers
is '' plan --dr
is '--exists=' info --exi
is --json info --js
for command in run info plan check render chart new-plugin; do
    for option in $(sph $command --help | grep -oE '^ .{1,5}--[a-z-]+' | grep -oE -- '--.*'); do
        case " $(ask $command -) " in
        *" $option "* | *" $option= "*) ;;
        *) echo "$command: no $option"; status=1 ;;
        esac
    done
done

# Their values
is 'magma' render --map = m
is 'magma' render --map m
has coolwarm render --map =
is 'cpu opencl opencl:0 opencl:1' --device ''
is '' --steps ''
is latest --resume = la
is results/checkpoint_00000010.h5 --resume = results/c
has gsph run --load ''
is mine.so run --load mi
is 'results/' run -o re
is 'results/' render re
is results/snapshot_0001.vtkhdf render results/s

is boundary new-plugin --kind = b
is autotools new-plugin --build a
is '' info --build x
is '' new-plugin t

# Names: of every plugin, and of items
for plugin in "$SPH_PLUGIN_PATH"/*.so; do has "$(basename "$plugin" .so)" info ''; done
is 'wendland-c2 wendland-c4 wendland-c6' info wend
is 'kernel/wendland-c2 kernel/wendland-c4 kernel/wendland-c6' info kernel/w
is 'plugin/gsph' info plugin/gs
is 'scheme/gsph' info --exists = scheme/gs
is 'gsph-rates' info --json gsph-r

# The other program
source "$1-plugin-check"
complete -p sph-plugin-check | grep -q -- '-F _sph_plugin_check' || { echo 'not set for sph-plugin-check'; status=1; }
_sph() { COMP_WORDS[0]=sph-plugin-check; _sph_plugin_check; }
is mine.so m
is mine.so --load = m
is --quiet --qu
is '--timeout=' --ti
is '' --only ''
exit $status
END_OF_BASH
PATH=$scratch/bin:$PATH bash --norc --noprofile -u "$scratch/ask.bash" \
    "$top_srcdir/core/cli/completions/sph"
