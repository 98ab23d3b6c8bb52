#!/usr/bin/env python3
"""Images of nibabel that do not say where they lie, taken as the command line takes them."""
import pathlib
import tempfile
import unittest

import anatomesh
import numpy as np
from support import needs, needs_program, nested_balls, run_program

try:
    import nibabel
except ModuleNotFoundError:
    nibabel = None

SPACING = (0.8, 1.1, 1.3)


def image_without_forms():
    """nibabel gives it an affine: of RAS but for a flip of the first axis, around the middle of the image."""
    image = nibabel.Nifti1Image(nested_balls(), None)
    image.header.set_zooms(SPACING)
    image.header.set_xyzt_units("mm")
    image.header["qform_code"] = image.header["sform_code"] = 0
    return image


def analyze_image():
    image = nibabel.AnalyzeImage(nested_balls(), None)
    image.header.set_zooms(SPACING)
    return image


@needs("nibabel")
class WithoutForms(unittest.TestCase):
    def expect_in_lps_from_the_origin_on(self, image):
        wanted = anatomesh.mesh(nested_balls(), spacing=[float(np.float32(s)) for s in SPACING])
        self.assertEqual(anatomesh.mesh_image(image).points.tobytes(), wanted.points.tobytes())

    def test_axes_are_those_of_lps(self):
        for make in (image_without_forms, analyze_image):
            with self.subTest(make.__name__):
                self.expect_in_lps_from_the_origin_on(make())

    @needs("meshio")
    @needs_program
    def test_files_give_the_bytes_of_the_command_line(self):
        import meshio

        for name, make in {"image.nii.gz": image_without_forms, "image.hdr": analyze_image}.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                file, mesh_file = pathlib.Path(folder, name), pathlib.Path(folder, "mesh.vtu")
                nibabel.save(make(), file)
                loaded = nibabel.load(file)
                self.assertEqual(loaded.header.get("sform_code", 0), 0)
                run_program("mesh", file, "-o", mesh_file, "--quiet")
                self.assertEqual(meshio.read(mesh_file).points.tobytes(), anatomesh.mesh_image(loaded).points.tobytes())
                self.expect_in_lps_from_the_origin_on(loaded)

    def test_units_are_minded(self):
        image = image_without_forms()
        image.header.set_zooms([1000 * s for s in SPACING])
        image.header.set_xyzt_units("micron")
        wanted = anatomesh.mesh(nested_balls(), spacing=[0.001 * float(np.float32(1000 * s)) for s in SPACING])
        self.assertEqual(anatomesh.mesh_image(image).points.tobytes(), wanted.points.tobytes())

    def test_an_affine_of_ones_own_counts(self):
        affine = np.diag([2.0, 3.0, 4.0, 1.0])
        image = nibabel.Nifti1Image(nested_balls(), affine)
        image.header["qform_code"] = image.header["sform_code"] = 0
        wanted = anatomesh.mesh(nested_balls(), affine=affine)
        self.assertEqual(anatomesh.mesh_image(image).points.tobytes(), wanted.points.tobytes())


if __name__ == "__main__":
    unittest.main()
