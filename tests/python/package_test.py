#!/usr/bin/env python3
"""What the package brings along, and what its page shows."""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import anatomesh
import numpy as np
from support import ROOT, needs, nested_balls

OTHER_PACKAGES = {"SimpleITK", "meshio", "nibabel", "pyvista"}


class Package(unittest.TestCase):
    @unittest.skipUnless(os.path.exists("/proc/self/maps"), "needs /proc")
    def test_loads_neither_itk_nor_vtk(self):
        program = (
            "import sys, anatomesh, numpy\n"
            "anatomesh.mesh(numpy.ones((6, 6, 6), int))\n"
            "print(*{line.split()[-1] for line in open('/proc/self/maps') if '/' in line}, sep='\\n')\n"
            "print(*sys.modules, sep='\\n')"
        )
        loaded = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout
        names = [pathlib.Path(line).name for line in loaded.splitlines()]
        self.assertTrue(any(name.startswith("_core") for name in names))
        self.assertTrue(any(name.startswith("libtbb") for name in names))
        foreign = re.compile(r"itk|vtk|^meshio|^nibabel|^pyvista", re.IGNORECASE)
        self.assertEqual([name for name in names if foreign.search(name)], [])

    def test_says_its_version_and_that_it_is_typed(self):
        self.assertIn(f"VERSION {anatomesh.__version__}", (ROOT / "CMakeLists.txt").read_text())
        self.assertTrue((pathlib.Path(anatomesh.__file__).parent / "py.typed").exists())

    def test_everything_public_is_described(self):
        for name in anatomesh.__all__:
            shown = getattr(anatomesh, name)
            if callable(shown) and name != "Progress":
                self.assertTrue(shown.__doc__, name)

    @needs("mypy")
    def test_its_types_hold(self):
        checked = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir", os.devnull, "-p",
             "anatomesh"], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


class Page(unittest.TestCase):
    """docs/python.md"""

    def test_its_examples_run_one_after_the_other(self):
        page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
        self.assertGreater(len(blocks), 5)
        names = {}
        with tempfile.TemporaryDirectory() as folder:
            self.addCleanup(os.chdir, os.getcwd())
            os.chdir(folder)
            self.write_image()
            for number, block in enumerate(blocks):
                with self.subTest(number), contextlib.redirect_stdout(io.StringIO()):
                    self.run_block(block, names)

    def run_block(self, block, names):
        try:
            exec(compile(block, "docs/python.md", "exec"), names)
        except ModuleNotFoundError as error:
            if error.name not in OTHER_PACKAGES:
                raise
            self.skipTest(f"{error.name} is not installed")

    def write_image(self):
        try:
            import nibabel
        except ModuleNotFoundError:
            return
        nibabel.save(nibabel.Nifti1Image(nested_balls(), np.eye(4)), "brain.nii.gz")


if __name__ == "__main__":
    unittest.main()
