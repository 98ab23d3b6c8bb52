#!/usr/bin/env python3
"""A mesh that follows its image."""
import unittest

import anatomesh
import numpy as np
from support import bars, nested_balls


class Following(unittest.TestCase):
    def setUp(self):
        self.voxels = bars(48)
        self.mesher = anatomesh.Remesher(self.voxels, spacing=(1, 1, 1.2), names={1: "one"}, frame="ras")

    def test_begins_with_the_mesh_of_the_image(self):
        mesh = anatomesh.mesh(self.voxels, spacing=(1, 1, 1.2), frame="ras")
        self.assertEqual(self.mesher.mesh.points.tobytes(), mesh.points.tobytes())
        self.assertEqual(self.mesher.mesh.tets.tobytes(), mesh.tets.tobytes())
        self.assertEqual(self.mesher.mesh.names, {1: "one"})
        self.assertIs(self.mesher.mesh, self.mesher.mesh)

    def test_an_update_leaves_what_was_handed_out(self):
        before = self.mesher.mesh
        points, kept = before.points, np.array(before.points)
        changed = self.voxels.copy()
        changed[20:26, 20:26, 20:26] = 0
        reports = []
        report = self.mesher.update(changed, progress=lambda *r: reports.append(r))
        self.assertEqual(report.changed_voxels, 216)
        self.assertGreater(report.new_tets, 0)
        self.assertEqual(report.whole, bool(report.reason))
        self.assertTrue(reports)
        np.testing.assert_array_equal(points, kept)
        after = self.mesher.mesh
        self.assertIsNot(after, before)
        self.assertEqual(after.assess(changed, spacing=(1, 1, 1.2), distances=False)["failed_guarantees"], [])

    def test_a_refused_or_cancelled_update_changes_nothing(self):
        before = self.mesher.mesh.points.tobytes()
        with self.assertRaisesRegex(anatomesh.InvalidInput, "another size"):
            self.mesher.update(self.voxels[1:])
        changed = np.where(self.voxels == 1, 0, self.voxels)
        with self.assertRaises(anatomesh.Cancelled):
            self.mesher.update(changed, progress=lambda *_: False)
        self.assertEqual(self.mesher.mesh.points.tobytes(), before)
        self.mesher.update(changed)
        self.assertNotIn(1, self.mesher.mesh.labels)

    def test_one_call_at_a_time(self):
        errors = []

        def progress(stage, fraction):
            for call in (lambda: self.mesher.update(self.voxels), lambda: self.mesher.mesh):
                try:
                    call()
                except anatomesh.Error as error:
                    errors.append(str(error))

        self.mesher.update(np.where(self.voxels == 1, 0, self.voxels), progress=progress)
        self.assertEqual(set(errors), {"the Remesher is at work on an update; wait until it is done"})

    def test_takes_the_options_of_mesh(self):
        mesher = anatomesh.Remesher(nested_balls(), max_elements=1500)
        self.assertEqual(mesher.mesh.options["fidelity"], 1)
        self.assertLessEqual(len(mesher.mesh.tets), 1500)


if __name__ == "__main__":
    unittest.main()
