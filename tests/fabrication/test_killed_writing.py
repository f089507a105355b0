"""A writer that is killed leaves the old file or the new one."""

import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "benchmarks" / "killed_writing.py"


def test_killed_writers_leave_whole_files() -> None:
    command = [sys.executable, str(SCRIPT), "2", "0"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("always whole\n")
    assert done.stdout.count("after 2 kills") == 3
