#!/usr/bin/env python3
"""Names and colours of labels on their way through the package."""
import pathlib
import pickle
import tempfile
import unittest

import anatomesh
import numpy as np
from support import needs, needs_program, nested_balls, run_program

NAMES = {1: "brain", 7: "tumour α"}
COLOURS = {1: (230, 180, 170), 7: (0, 255, 30)}


class Colours(unittest.TestCase):
    mesh = anatomesh.mesh(nested_balls(), names=NAMES, colours={**COLOURS, 9: (1, 2, 3)})

    def test_of_the_image_are_those_of_the_mesh(self):
        self.assertEqual((self.mesh.names, self.mesh.colours), (NAMES, COLOURS))
        self.assertEqual(anatomesh.mesh(nested_balls()).colours, {})
        arrays = {7: np.array([0, 255, 30], np.uint8), 1: [230, 180, 170]}
        self.assertEqual(anatomesh.mesh(nested_balls(), colours=arrays).colours, COLOURS)

    def test_need_no_name(self):
        mesh = anatomesh.mesh(nested_balls(), names={1: "brain"}, colours={7: (1, 2, 3)})
        self.assertEqual((mesh.names, mesh.colours), ({1: "brain"}, {7: (1, 2, 3)}))

    def test_stay_when_the_image_changes(self):
        voxels = nested_balls()
        mesher = anatomesh.Remesher(voxels, names=NAMES, colours=COLOURS)
        voxels[12, 14, 12] = 1
        mesher.update(voxels)
        self.assertEqual((mesher.mesh.names, mesher.mesh.colours), (NAMES, COLOURS))

    def test_can_be_given_to_a_mesh_and_pickled(self):
        mesh = anatomesh.Mesh(self.mesh.points, self.mesh.tets, self.mesh.labels, NAMES, COLOURS)
        self.assertEqual(mesh.colours, COLOURS)
        self.assertEqual(pickle.loads(pickle.dumps(mesh)).colours, COLOURS)

    def test_that_are_none_are_refused(self):
        for colour in ((1, 2), (1, 2, 256), (-1, 2, 3), (0.5, 0.5, 0.5), "red", None):
            message = r"the colour of label 7 is .*; it must be red, green and blue, whole numbers from 0 to 255"
            with self.subTest(colour), self.assertRaisesRegex(anatomesh.InvalidInput, message):
                anatomesh.mesh(nested_balls(), colours={7: colour})

    @needs("meshio")
    @needs_program
    def test_of_a_file_of_the_command_line_come_through_meshio(self):
        import meshio
        import nibabel

        with tempfile.TemporaryDirectory() as folder:
            image, table, file = (pathlib.Path(folder, name) for name in ("i.nii.gz", "names.csv", "m.vtu"))
            nibabel.save(nibabel.Nifti1Image(nested_balls(), np.eye(4)), image)
            lines = [",".join(map(str, (label, NAMES[label], *COLOURS[label]))) for label in NAMES]
            table.write_text("\n".join(lines) + "\n", encoding="utf-8")
            run_program("mesh", image, "-o", file, "--names", table, "--quiet")
            read = anatomesh.Mesh.from_meshio(meshio.read(file))
        self.assertEqual((read.names, read.colours), (NAMES, COLOURS))

    @needs("pyvista")
    def test_go_to_pyvista_where_all_labels_have_one(self):
        grid = self.mesh.to_pyvista()
        self.assertEqual(grid.field_data["label_values"].tolist(), [1, 7])
        self.assertEqual(grid.field_data["label_colours"].tolist(), [list(COLOURS[label]) for label in (1, 7)])
        some = anatomesh.mesh(nested_balls(), names=NAMES, colours={7: (1, 2, 3)}).to_pyvista()
        self.assertNotIn("label_colours", some.field_data)


if __name__ == "__main__":
    unittest.main()
