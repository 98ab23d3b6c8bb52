#!/usr/bin/env python3
"""Runs the commands, the Python and the C++ (as far as compiling goes) that the pages of docs/ show.

usage: docs_commands_test.py ANATOMESH      exit status 77 (skipped) without numpy or nibabel

Each page has a folder with the small images that are made below, under the names that pages give to theirs; its blocks
run there one after the other, the Python in one interpreter. Blocks are told by their language, or, without one, by a
first word that is a program. A comment before a block says what else becomes of it:

    <!-- not run: WHY -->     it is listed and passed over
    <!-- file: NAME -->       it is put into a file, for later blocks

Commands of programs that are not installed, and Python that needs such packages, are skipped and listed. PYTHONPATH
names the folder with the Python package.
"""
import contextlib
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import typing
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
try:
    import nibabel
    import numpy as np
    from make_vessel_tree import write_nifti
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

PAGES = ("README.md", *(f"docs/{name}.md" for name in (
    "command-line", "cpp", "fenics", "formats", "gmsh-and-medit", "inputs", "python", "solvers", "surface_files")))

# First words by which a block without a language is one of commands.
PROGRAMS = {"anatomesh", "apt", "ccx", "cd", "cmake", "gmsh", "pip", "printf", "tetgen"}
LANGUAGES = {"sh": "sh", "bash": "sh", "console": "sh", "python": "python", "cpp": "cpp"}
# Packages that a page may do without; the names of their modules.
OPTIONAL_MODULES = {"SimpleITK", "anatomesh", "dolfin", "dolfinx", "meshio", "mpi4py", "nibabel", "pyvista"}

BLOCK = re.compile(r"(?:^<!-- (?P<mark>not run|file): (?P<says>[^\n]*) -->\n)?"
                   r"^```(?P<language>[^`\n]*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)


class Block(typing.NamedTuple):
    """A fenced block of a page."""
    place: str     # page and line
    language: str  # sh, python or cpp; "" is shown only
    text: str
    mark: str      # "not run", "file" or ""
    says: str      # what the mark says


def blocks_of(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        line = text.count("\n", 0, found.start("text")) + 1
        language = LANGUAGES.get(found["language"], "")
        first_word = (found["text"].split() or [""])[0]
        if not found["language"] and first_word in PROGRAMS:
            language = "sh"
        yield Block(f"{page}:{line}", language, found["text"], found["mark"] or "", found["says"] or "")


# ---- the images

def balls(inner, outer, further=()):
    """A ball of one label in one of another, both cut by the end of the image; further labels are cubes."""
    i, j, k = np.indices((26, 24, 22))
    distance = (i - 12) ** 2 + (j - 11) ** 2 + (k - 6) ** 2
    voxels = np.select([distance <= 64, distance <= 110], [inner, outer], 0)
    for n, label in enumerate(further):
        voxels[6 * n + 2 : 6 * n + 6, 8:14, 17:21] = label
    return voxels.astype(np.uint8)


def write_nrrd(path, voxels):
    sizes = " ".join(map(str, voxels.shape))
    header = (f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {sizes}\n"
              "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n")
    path.write_bytes(header.encode() + voxels.tobytes(order="F"))


def write_mgz(path, voxels):
    nibabel.save(nibabel.freesurfer.mghformat.MGHImage(voxels, np.eye(4)), path)


def write_gmsh_file(path):
    """One tetrahedron, as version 2.2 has it."""
    path.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
                    "$Elements\n1\n1 4 2 5 5 1 2 3 4\n$EndElements\n")


def make_inputs(folder):
    """What pages take for granted. 3 is the shell, 17 the core of the brain that all of them mesh."""
    write_nifti(folder / "brain.nii.gz", balls(3, 17), 1.0)
    write_nifti(folder / "liver.nii.gz", balls(2, 2), 1.0)
    write_nifti(folder / "vessels.nii.gz", balls(1, 0), 1.0)
    write_nifti(folder / "tumour.nii.gz", balls(0, 0, (1, 1)), 1.0)
    write_nrrd(folder / "head.nrrd", balls(3, 1, (10, 12)))
    write_nrrd(folder / "atlas.nrrd", balls(2, 4))
    (folder / "SPL-BrainAtlas.ctbl").write_text("# Color table file\n2 left_kidney 185 102 83 255\n"
                                                "4 cortex 1 2 3 255\n")
    (folder / "names.csv").write_text("label,name\n2,left kidney\n4,cortex\n")
    write_mgz(folder / "aparc+aseg.mgz", balls(4, 2))
    (folder / "FreeSurferColorLUT.txt").write_text("2 Left-Cerebral-White-Matter 245 245 245 0\n"
                                                   "4 Left-Lateral-Ventricle 120 18 134 0\n")
    for name in ("theirs.msh", "old.msh"):
        write_gmsh_file(folder / name)


# ---- running

class Page:
    """A page's folder, which is the working folder, and the names that its Python has defined.

    Counts what was run; what was passed over is told in sentences.
    """

    def __init__(self, folder):
        self.folder, self.names, self.ran, self.passed_over = folder, {}, 0, []
        make_inputs(folder)

    def run(self, block):
        if block.mark == "not run":
            self.passed_over.append(f"not run: {block.place}: {block.says}")
        elif block.mark == "file":
            (self.folder / block.says).write_text(block.text, encoding="utf-8")
        elif block.language:
            {"sh": self.run_commands, "python": self.run_python, "cpp": self.compile}[block.language](block)

    def run_commands(self, block):
        for command in block.text.replace("\\\n", " ").splitlines():
            program = (command.split() or ["#"])[0]
            if program.startswith("#"):
                continue
            if shutil.which(program, path=PATH) is None:
                self.passed_over.append(f"skipped: {block.place}: {program} is not installed")
                continue
            self.expect_success(block, ["bash", "-c", command])
            self.ran += 1

    def run_python(self, block):
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block.text, block.place, "exec"), self.names)
            self.ran += 1
        except ModuleNotFoundError as error:
            if error.name.split(".")[0] not in OPTIONAL_MODULES:
                raise
            self.passed_over.append(f"skipped: {block.place}: {error.name} is not installed")

    def compile(self, block):
        """Its includes stand at the top of a file, the rest of it in a function."""
        compiler = shutil.which(os.environ.get("CXX", "c++"))
        if compiler is None:
            self.passed_over.append(f"skipped: {block.place}: no compiler is installed")
            return
        lines = block.text.splitlines()
        includes = [line for line in lines if line.startswith("#")]
        body = [line for line in lines if not line.startswith("#")]
        source = self.folder / "block.cpp"
        source.write_text("\n".join([*includes, "void block() {", *body, "}", ""]), encoding="utf-8")
        self.expect_success(block, [compiler, "-std=c++20", "-fsyntax-only", f"-I{ROOT / 'include'}", source])
        self.ran += 1

    def expect_success(self, block, command):
        done = subprocess.run(command, cwd=self.folder, env={**os.environ, "PATH": PATH}, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode:
            raise AssertionError(f"{block.place}: exit status {done.returncode} of\n{command[-1]}\n{done.stdout}")


class Docs(unittest.TestCase):
    def check_page(self, page):
        with tempfile.TemporaryDirectory() as folder:
            self.addCleanup(os.chdir, os.getcwd())
            os.chdir(folder)
            here = Page(pathlib.Path(folder))
            for block in blocks_of(page):
                here.run(block)
        print(f"{page}: {here.ran} commands and blocks were run", *here.passed_over, sep="\n")

    def test_blocks_are_found(self):
        """On every page, so that a change of the way they are written does not go unseen."""
        for page in PAGES:
            with self.subTest(page):
                self.assertTrue(any(block.language for block in blocks_of(page)))


def test_of(page):
    return lambda self: self.check_page(page)


for name in PAGES:
    setattr(Docs, "test_" + re.sub(r"\W", "_", name), test_of(name))

if __name__ == "__main__":
    PATH = f"{pathlib.Path(sys.argv[1]).resolve().parent}{os.pathsep}{os.environ['PATH']}"
    unittest.main(argv=sys.argv[:1])
