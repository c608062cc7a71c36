"""All of tests/device.py."""
import os
import runpy

os.environ["SPH_DEVICE_LONG"] = "1"
runpy.run_path(os.path.join(os.path.dirname(os.path.abspath(__file__)), "device.py"), run_name="__main__")
