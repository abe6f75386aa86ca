"""Runs every ```python fence of the documentation: a complete script, alone, with `out.glb` as its argument, in a folder with

    scene.obj  out.glb  transfer.npz  light.json  radiance.npz

as `bake`, `export`, `light` and `shade` write them. A fence fails by raising; what it writes stays in a folder of its own.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import program
from program import relume

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```python[ \t]*\n(.*?)^```[ \t]*$", re.MULTILINE | re.DOTALL)


def pages():
    """The README and the documentation."""
    return [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))) if page.is_file()]


class Fences(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.files = Path(scratch.name) / "files"
        cls.files.mkdir()
        scene, asset, light = (cls.files / name for name in ("scene.obj", "out.glb", "light.json"))
        program.write_scene(scene)
        relume("bake", scene, "-o", asset, "--samples", 256, "--bounces", 1)
        relume("export", asset, "-o", cls.files / "transfer.npz")
        glossy = cls.files / "glossy.glb"
        relume("bake", scene, "-o", glossy, "--samples", 64, "--transfer", "glossy", "--transfer-order", 3, "--brdf", "phong")
        relume("export", glossy, "-o", cls.files / "compound.npz", "--compound", 2)
        relume("light", "sky:30,3", "-o", light)
        relume("shade", asset, "--light", light, "-o", cls.files / "radiance.npz")

    def run_fence(self, code):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            shutil.copytree(self.files, folder)
            path = os.pathsep.join([str(Path(program.PROGRAM).resolve().parent), os.environ.get("PATH", "")])
            done = subprocess.run(
                [sys.executable, "-c", code, "out.glb"], cwd=folder, capture_output=True, text=True, env={**os.environ, "PATH": path}
            )
            self.assertEqual(done.returncode, 0, f"{code}\n{done.stdout}{done.stderr}")


def add_tests():
    """One test per fence, named by page and line."""
    for page in pages():
        text = page.read_text(encoding="utf-8")
        for match in FENCE.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            name = re.sub(r"\W", "_", str(page.relative_to(ROOT)))
            test = lambda self, code=match.group(1): self.run_fence(code)  # noqa: E731
            setattr(Fences, f"test_{name}_line_{line}", test)


add_tests()

if __name__ == "__main__":
    unittest.main()
