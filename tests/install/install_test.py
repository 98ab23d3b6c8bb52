#!/usr/bin/env python3
"""Installs a build into an empty folder, moves it, and builds and runs the examples against it, by CMake and by pkg-config.

usage: install_test.py BUILD_FOLDER EXAMPLES_FOLDER COMPILER
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD, EXAMPLES, COMPILER = (pathlib.Path(p) for p in sys.argv[1:4])


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


def write_nrrd(path, side=24):
    """A cube of label 3 in background."""
    inside = range(side // 4, 3 * side // 4)
    voxels = bytes(3 if i in inside and j in inside and k in inside else 0
                   for k in range(side) for j in range(side) for i in range(side))
    path.write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
                     + f"sizes: {side} {side} {side}\n".encode()
                     + b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n" + voxels)


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        first = cls.folder / "first"
        run("cmake", "--install", BUILD, "--prefix", first)
        cls.prefix = cls.folder / "moved"
        first.rename(cls.prefix)
        cls.libraries = next(cls.prefix.rglob("libanatomesh.so")).parent

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def test_cmake_builds_the_examples_against_it(self):
        build = self.folder / "examples"
        run("cmake", "-S", EXAMPLES, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={COMPILER}",
            "-DCMAKE_BUILD_TYPE=Release")
        run("cmake", "--build", build)
        self.assertIn("core: ", run(build / "mesh_ball"))
        image, mesh = self.folder / "cube.nrrd", self.folder / "cube.vtu"
        write_nrrd(image)
        self.assertRegex(run(build / "mesh_file", image, mesh), r"^\d+ tetrahedra\n$")
        self.assertGreater(mesh.stat().st_size, 1000)

    def test_unknown_components_are_refused(self):
        source = self.folder / "unknown"
        source.mkdir()
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.16)\nproject(unknown NONE)\n"
                                               "find_package(anatomesh REQUIRED COMPONENTS nonsense)\n")
        done = subprocess.run(["cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"],
                              capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no component 'nonsense'", done.stderr)

    def test_pkg_config_knows_it(self):
        environment = {**os.environ, "PKG_CONFIG_PATH": str(self.libraries / "pkgconfig")}
        flags = run("pkg-config", "--cflags", "--libs", "anatomesh", env=environment).split()
        program = self.folder / "mesh_ball"
        run(COMPILER, "-std=c++20", EXAMPLES / "mesh_ball.cpp", "-o", program, *flags, f"-Wl,-rpath,{self.libraries}")
        self.assertIn("shell: ", run(program))
        self.assertIn("-lanatomesh_io", run("pkg-config", "--libs", "anatomesh_io", env=environment))

    def test_the_mesher_needs_neither_itk_nor_vtk(self):
        needed = run("ldd", self.libraries / "libanatomesh.so")
        self.assertNotRegex(needed, "(?i)itk|vtk|hdf5")
        self.assertIn("libtbb", needed)

    def test_headers_stand_alone(self):
        for header in sorted((self.prefix / "include/anatomesh").glob("*.h")):
            run(COMPILER, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", f"-I{self.prefix}/include", "-include", header,
                "-x", "c++", "/dev/null")

    def test_the_program_runs(self):
        self.assertRegex(run(self.prefix / "bin/anatomesh", "--version"), r"^anatomesh \d+\.\d+\.\d+\n$")

    def test_debian_packages(self):
        packages = self.folder / "deb"
        packages.mkdir()
        run("cpack", "-G", "DEB", "-B", packages, "--config", BUILD / "CPackConfig.cmake")
        contents = {}
        for package in packages.glob("*.deb"):
            name = run("dpkg-deb", "-f", package, "Package").strip()
            contents[name] = run("dpkg-deb", "-c", package)
        self.assertEqual(set(contents), {"anatomesh", "libanatomesh", "libanatomesh-io", "libanatomesh-dev"})
        self.assertIn("/usr/bin/anatomesh", contents["anatomesh"])
        self.assertIn("/include/anatomesh/image_to_mesh.h", contents["libanatomesh-dev"])
        depends = run("dpkg-deb", "-f", next(packages.glob("libanatomesh_*.deb")), "Depends")
        self.assertIn("libtbb", depends)
        self.assertNotIn("vtk", depends)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
