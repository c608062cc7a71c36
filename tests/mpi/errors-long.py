"""tests/mpi/errors.py with memory refused at sixty calls."""
import os
import runpy
import sys

os.environ["SPH_TRIES"] = "60"
here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, here)
runpy.run_path(os.path.join(here, "errors.py"), run_name="__main__")
