"""For tests that have an installed tree alone: staged() starts the script again with one of its own, as
tests/install/stage.sh makes it, and gives back (the source's folder, a temporary folder)."""
import os
import subprocess
import sys

START = """
script=$1 python=$2 source=$3
. "$source/tests/install/stage.sh"
stage
STAGED=$stage_dir SOURCE=$source "$python" "$script"
"""


def staged():
    if "STAGED" in os.environ:
        return os.environ["SOURCE"], os.environ["STAGED"]
    script = os.path.abspath(sys.argv[0])
    source = os.environ.get("top_srcdir") or os.path.dirname(os.path.dirname(os.path.dirname(script)))
    os.environ["top_srcdir"] = source
    os.environ.setdefault("top_builddir", os.getcwd())
    python = os.environ.get("PYTHON") or sys.executable
    sys.exit(subprocess.run(["sh", "-euc", START, "sh", script, python, source]).returncode)
