"""All of tests/mpi/device.py, on more ranks, in more precisions, and with programs that nobody has built yet."""
import os
import runpy

os.environ["SPH_DEVICE_LONG"] = "1"
runpy.run_path(os.path.join(os.path.dirname(os.path.abspath(__file__)), "device.py"), run_name="__main__")
