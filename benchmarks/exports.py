"""Does a process that writes a Rhino file end well? Ten of them, one after the other.

    python benchmarks/exports.py

Panels as Breps, as blocks and as a shell, edges, centres, beams with their axes, render meshes
and a reference: whatever rhino3dm may have to clean up at exit. Prints the ten exit codes.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

CODE = """
import sys, warnings
from spheremesh import nodes
warnings.simplefilter("ignore")
mesh = nodes.torus_mesh(12, 8)
spheres = nodes.central_spheres(mesh)
made = nodes.panels(spheres, edges="intersection", thickness=0.01).panels
beams = nodes.beams(nodes.annulus_support(spheres).annuli).beams
for shape in ("panels", "blocks", "shell"):
    nodes.write_3dm(
        made, f"{sys.argv[1]}/{shape}.3dm", beams=beams, reference=mesh, shape=shape,
        layers=("Edges", "Centres"),
    )
"""


def main() -> None:
    """Run, and exit with 1 if one of them did not end well."""
    codes: list[int] = []
    for _ in range(10):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", CODE, folder]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            codes.append(done.returncode)
            written = len(list(Path(folder).iterdir()))
            if done.returncode or done.stderr or written != 3:
                print(f"{written} files; {done.stderr.strip()}")
    print("exit codes", *codes)
    sys.exit(any(codes))


if __name__ == "__main__":
    main()
