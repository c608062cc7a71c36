"""tests/mpi/kill.py with ten kills."""
import os
import runpy
import sys

os.environ["SPH_KILLS"] = "10"
here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, here)
runpy.run_path(os.path.join(here, "kill.py"), run_name="__main__")
