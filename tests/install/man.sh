#!/bin/sh
# The manual knows every command and every option that --help does, and no others; sph-scene knows the
# scenes' keys. Help fits 80 columns. (tests/install/man-lint.sh looks at the pages' form.)
set -eu
: "${top_srcdir:?}" "${top_builddir:?}" "${SPH:?}" "${PYTHON:?}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
man=$top_srcdir/man
status=0

fail() { echo "$*"; status=1; }

# The options in a help's left column, and those that head an entry of a page.
of_help() { sed -n 's/^ \{2,6\}\(-[^-], \)\{0,1\}\(--[a-z-]*\).*/\2/p' "$1" | sort; }
short_of_help() { sed -n 's/^  \(-[^-]\), .*/\1/p' "$1" | sort; }
of_page() { sed -n 's/^\.It Fl \(.* Fl \)\{0,1\}\(-[a-z-]*\).*/-\2/p' "$1" | sort; }
short_of_page() { sed -n 's/^\.It Fl \([a-zA-Z]\) .*/-\1/p' "$1" | sort; }

# same HELP PAGE NAME: but for the options that all commands have
same() {
    of_help "$1" | grep -vxE -e '--(help|usage|version)' >"$scratch/help" || :
    of_page "$2" >"$scratch/page"
    diff "$scratch/help" "$scratch/page" || fail "$3: --help (<) and the manual (>) differ"
    short_of_help "$1" | grep -vxE -e '-[?V]' >"$scratch/help" || :
    short_of_page "$2" >"$scratch/page"
    diff "$scratch/help" "$scratch/page" || fail "$3: short options of --help (<) and the manual (>) differ"
    if grep -nE '.{81}' "$1"; then fail "$3 --help: wider than 80 columns"; fi
    # argp forgets it where the last line is full.
    [ "$(tail -c 1 "$1" | wc -l)" -eq 1 ] || fail "$3 --help: no end of line (change the last words)"
}

"$SPH" --help >"$scratch/sph"
if grep -nE '.{81}' "$scratch/sph"; then fail 'sph --help: wider than 80 columns'; fi
commands=$(sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p' "$scratch/sph")
[ "$(echo "$commands" | wc -l)" -ge 5 ] || fail 'sph --help lists no commands'
for command in $commands; do
    "$SPH" "$command" --help >"$scratch/command" || fail "sph $command --help: $?"
    section=$(echo "$command" | tr a-z A-Z)
    awk -v section="$section" '/^\.Sh / { inside = $2 == section } inside' "$man/sph.1" >"$scratch/section"
    [ -s "$scratch/section" ] || fail "sph.1 has no section $section"
    grep -qE "^\.(Op )?Cm $command\$" "$man/sph.1" || fail "sph.1: no $command in its synopsis"
    same "$scratch/command" "$scratch/section" "sph $command"
done

# A program of its own, once it is there.
if [ -x "$top_builddir/sph-plugin-check" ]; then
    "$top_builddir/sph-plugin-check" --help >"$scratch/command" || fail "sph-plugin-check --help: $?"
    same "$scratch/command" "$man/sph-plugin-check.1" sph-plugin-check
fi

# Every page that another one names, and every page that there is, is installed.
for name in $(sed -n 's/^\.Xr \(sph[a-z-]*\) \([1-9]\).*/\1.\2/p' "$man"/*.[1-9] | sort -u); do
    [ -f "$man/$name" ] || fail "no manual page $name"
done
for page in "$man"/*.[1-9]; do
    grep -qF "man/$(basename "$page")" "$man/fragment.am" || fail "not in man/fragment.am: $page"
done

"$PYTHON" - "$top_srcdir/examples/scene.schema.json" >"$scratch/keys" <<'END_OF_PYTHON'
import json, sys
print("\n".join(sorted(json.load(open(sys.argv[1]))["properties"])))
END_OF_PYTHON
sed -n 's/^\.It Ic //p' "$man/sph-scene.5" | sort >"$scratch/page"
diff "$scratch/keys" "$scratch/page" || fail "sph-scene.5: the schema's keys (<) and the page's (>) differ"
sed -n '/^\.Bd -literal$/,/^\.Ed$/p' "$man/sph-scene.5" | sed '/^\./d' >"$scratch/scene.json"
"$SPH" check "$scratch/scene.json" >"$scratch/out" 2>&1 || { cat "$scratch/out"; fail 'sph-scene.5: its scene is wrong'; }
exit $status
