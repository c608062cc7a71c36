"""What watch.py expects of runs that go wrong holds on an OpenCL device: the same causes, particles and sentences."""
import os
import runpy
import sys

from scenes import Scenes

Scenes().need_device()
sys.argv[1:] = ["--device=opencl", "--device-only"]
runpy.run_path(os.path.join(os.environ["top_srcdir"], "tests", "watch.py"))
