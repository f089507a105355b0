"""Scripts of users that add a node pass pyright at its strictest."""

import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
TUTORIAL = ROOT / "docs" / "tutorials" / "2-own-node.md"


def pyright(folder: Path, script: str) -> str:
    (folder / "script.py").write_text(script, encoding="utf-8")
    settings = folder / "pyrightconfig.json"
    settings.write_text(json.dumps({"typeCheckingMode": "strict"}), encoding="utf-8")
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "-p", folder]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=folder
    ).stdout


def test_the_tutorial_passes_and_a_mistake_does_not(tmp_path: Path) -> None:
    blocks = re.findall(
        r"^```python\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    (tmp_path / "daylight.py").write_text(blocks[0], encoding="utf-8")
    said = pyright(tmp_path, "".join(blocks[1:]) + 'daylight.facing("a mesh")\n')
    assert said.count(" - error: ") == 1, said
    assert '"Literal[\'a mesh\']" is not assignable to "Mesh"' in said
