#!/usr/bin/env python3
"""tools/check_layers.py must catch each kind of violation, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check_layers.py"

# file, its one include, part of the complaint
VIOLATIONS = [
    ("src/mesh/a.cpp", '"lattice/bcc_lattice.h"', "above mesh"),
    ("src/lattice/a.cpp", '"fem/solver.h"', "a sibling of lattice"),
    ("src/base/a.cpp", '"anatomesh/image_to_mesh.h"', "above base"),
    ("src/deform/a.cpp", '"anatomesh/io.h"', "above deform"),
    ("src/deform/a.cpp", '"assess/quality.h"', "a sibling of deform"),
    ("src/mesh/a.cpp", "<tbb/parallel_for.h>", "oneTBB"),
    ("src/deform/a.cpp", "<Eigen/Sparse>", "Eigen"),
    ("src/image/a.cpp", "<itkImage.h>", "ITK"),
    ("src/assess/a.cpp", "<vtkMeshQuality.h>", "VTK"),
    ("src/io/a.cpp", "<nlohmann/json.hpp>", "JSON"),
    ("src/io/a.cpp", "<pybind11/numpy.h>", "pybind11"),
    ("src/helpers/a.cpp", "<vector>", "has no floor"),
    ("src/lattice/a.cpp", "<CGAL/Image_3.h>", "CGAL"),
    ("src/io/a.cpp", '"nowhere/a.h"', "neither of a floor nor public"),
    ("include/anatomesh/a.h", "<Eigen/Core>", "Eigen"),
    ("include/anatomesh/a.h", '"base/vec.h"', "a public header"),
    ("include/anatomesh/a.h", "<fmt/core.h>", "fmt"),
    ("apps/a.cpp", '"mesh/adjacency.h"', "sees only anatomesh/*.h"),
    ("plugins/sofa/a.cpp", '"lattice/bcc_lattice.h"', "sees only anatomesh/*.h"),
]

ALLOWED = [
    ("src/lattice/a.cpp", '"mesh/adjacency.h"'),
    ("src/lattice/a.cpp", '"lattice/bcc_lattice.h"'),
    ("src/assess/a.cpp", '"anatomesh/assess.h"'),
    ("src/base/a.cpp", "<tbb/info.h>"),
    ("src/io/a.cpp", "<itkImage.h>"),
    ("apps/a.cpp", '"anatomesh/io.h"'),
    ("apps/a.cpp", "<CLI/CLI.hpp>"),
    ("include/anatomesh/a.h", "<vector>"),
]


def check(file, include):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, file)
        path.parent.mkdir(parents=True)
        path.write_text(f"#include {include}\n", encoding="utf-8")
        done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class CheckLayers(unittest.TestCase):
    def test_catches_each_violation(self):
        for file, include, complaint in VIOLATIONS:
            with self.subTest(file=file, include=include):
                status, output = check(file, include)
                self.assertEqual(status, 1)
                self.assertIn(complaint, output)
                self.assertIn(file, output)

    def test_allows_what_is_in_place(self):
        for file, include in ALLOWED:
            with self.subTest(file=file, include=include):
                self.assertEqual(check(file, include)[0], 0)


if __name__ == "__main__":
    unittest.main()
