#!/usr/bin/env python3
"""One options struct feeds everything: its members are the options of the package, nothing else."""
import re
import unittest

import anatomesh
import numpy as np
from support import ROOT, nested_balls

MEMBER = re.compile(r"^  [A-Za-z0-9_:<>, ]+ (\w+)(?: = [^;]+)?;")

# Every option with a value that is not its default.
OTHER_VALUES = {
    "bcc_size_mm": 6.0,
    "min_size_mm": 1.5,
    "fidelity": 0.9,
    "fidelity_label": {7: 0.8},
    "fidelity_stage": "lattice",
    "max_elements": 0,
    "size_label": {1: 4.0},
    "elements_across": 1,
    "drop_islands": 3,
    "allow_non_manifold": True,
    "non_connectivity": "edge",
    "iterations": 2,
    "min_dihedral_deg": 12.0,
    "max_dihedral_deg": 160.0,
    "min_mean_ratio": 0.1,
    "gradation": 0.75,
    "material": {7: {"young_modulus_pa": 9000.0, "poisson_ratio": 0.4}},
    "default_material": {"young_modulus_pa": 2000.0, "poisson_ratio": 0.3},
    "labels": [1, 7],
    "frame": "ras",
    "order": 2,
    "threads": 1,
    "max_memory_gib": 4.0,
}


def members():
    """The members of the structs of the header, by struct."""
    of_struct, struct = {}, None
    for line in (ROOT / "include" / "anatomesh" / "options.h").read_text().splitlines():
        begin = re.match(r"struct (\w+)", line)
        struct = begin.group(1) if begin else struct
        member = MEMBER.match(line)
        if member and struct:
            of_struct.setdefault(struct, set()).add(member.group(1))
    return of_struct


class OptionNames(unittest.TestCase):
    def test_are_the_members_of_the_option_structs(self):
        structs = members()
        self.assertEqual(set(structs), {"Material", "LatticeOptions", "DeformOptions", "Options"})
        wanted = structs["LatticeOptions"] | structs["DeformOptions"] | structs["Options"] - {"lattice", "deform"}
        self.assertGreaterEqual(len(wanted), 20)
        self.assertEqual(set(anatomesh.default_options()), wanted)
        self.assertEqual(set(anatomesh.Options.__annotations__), wanted)
        self.assertEqual(set(anatomesh.Material.__annotations__), structs["Material"])
        self.assertEqual(set(OTHER_VALUES), wanted)

    def test_that_does_not_exist_is_named_with_a_near_one(self):
        with self.assertRaisesRegex(TypeError, r"mesh\(\) has no option 'bcc_size'; did you mean 'bcc_size_mm'\?"):
            anatomesh.mesh(nested_balls(), bcc_size=3)
        with self.assertRaisesRegex(TypeError, r"Remesher\(\) has no option 'zzz'"):
            anatomesh.Remesher(nested_balls(), zzz=3)


class OptionValues(unittest.TestCase):
    def test_reach_the_mesher_and_come_back(self):
        defaults = anatomesh.default_options()
        mesh = anatomesh.mesh(nested_balls(), **OTHER_VALUES)
        for name, value in OTHER_VALUES.items():
            with self.subTest(name):
                self.assertEqual(mesh.options[name], value)
                if name != "max_elements":
                    self.assertNotEqual(value, defaults[name])

    def test_may_be_of_numpy(self):
        mesh = anatomesh.mesh(
            nested_balls(), labels=np.array([7], np.uint8), iterations=np.int64(3), fidelity=np.float32(0.5), threads=1
        )
        self.assertEqual((mesh.options["labels"], mesh.options["iterations"]), ([7], 3))
        self.assertEqual(set(mesh.labels), {7})

    def test_a_budget_asks_for_the_best_fidelity(self):
        voxels = nested_balls()
        self.assertEqual(anatomesh.mesh(voxels, max_elements=2000).options["fidelity"], 1)
        self.assertEqual(anatomesh.mesh(voxels, max_elements=2000, fidelity=0.9).options["fidelity"], 0.9)
        self.assertLessEqual(len(anatomesh.mesh(voxels, max_elements=2000).tets), 2000)

    def test_materials_may_be_kinds_and_take_what_they_lack_from_the_default(self):
        options = anatomesh.mesh(
            nested_balls(), material={7: "tumour", 1: {"poisson_ratio": 0.2}}, default_material={"young_modulus_pa": 10}
        ).options
        self.assertEqual(options["material"][7], {"young_modulus_pa": 9000, "poisson_ratio": 0.45})
        self.assertEqual(options["material"][1], {"young_modulus_pa": 10, "poisson_ratio": 0.2})

    def test_that_are_wrong_are_named_with_what_is_right(self):
        cases = [
            ({"fidelity": 1.5}, r"fidelity is 1\.5; it must be above 0 and at most 1"),
            ({"fidelity": "high"}, "fidelity is 'high'; it must be a number"),
            ({"fidelity": None}, "fidelity is None; it must be a number"),
            ({"iterations": 2.5}, r"iterations is 2\.5; it must be a whole number"),
            ({"max_elements": -1}, "max_elements is -1; it must be a whole number, at least 0"),
            ({"frame": "lpi"}, "frame is 'lpi'; it must be 'lps' or 'ras'"),
            ({"frame": 3}, "frame is 3; it must be 'lps' or 'ras'"),
            ({"labels": 3}, r"labels is 3; it must be labels, e\.g\. \[1, 2\]"),
            ({"labels": [-1]}, "labels is -1; it must be a label"),
            ({"labels": [7, 5]}, "labels names label 5"),
            ({"size_label": 2}, "size_label is 2; it must be a dict by label"),
            ({"size_label": {1: "x"}}, r"size_label\[1\] is 'x'; it must be a number"),
            ({"size_label": {-4: 2}}, "a key of size_label is -4; it must be a label"),
            ({"material": {7: "wood"}}, r"material\[7\] is 'wood'; it must be 'brain' or"),
            ({"material": {7: {"young": 1}}}, r"a key of material\[7\] is 'young'; it must be 'young_modulus_pa' or"),
            ({"allow_non_manifold": "yes"}, "allow_non_manifold is 'yes'; it must be True or False"),
        ]
        for options, message in cases:
            with self.subTest(options), self.assertRaisesRegex(anatomesh.InvalidOption, message):
                anatomesh.mesh(nested_balls(), **options)


if __name__ == "__main__":
    unittest.main()
