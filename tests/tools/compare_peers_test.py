#!/usr/bin/env python3
"""benchmarks/compare_peers.py: the search for sizes, what is said of a peer, and the page; and the tools it rests on."""
import pathlib
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "benchmarks"), str(ROOT / "tools")]
import compare_peers  # noqa: E402
import measured_run  # noqa: E402
import mesh_figures  # noqa: E402
import pages  # noqa: E402

OURS = {"tets": 1000, "dihedral_deg": [20.0, 150.0], "dihedral_p1_deg": 22.5, "mean_ratio": [0.3, 0.8],
        "dice": [0.95, 0.97], "surface_mm": [0.20, 0.9], "large_surface_mm": [0.21, 0.8], "large_volume_percent": -0.5,
        "normal_jump_deg": 10.0, "nonmanifold": [0, 0], "wrong_parts": 0, "missing_labels": 0, "tissues": 3, "cpu_s": 1.0,
        "memory_mb": 100.0}
WORSE = {**OURS, "dihedral_deg": [5.0, 170.0], "surface_mm": [0.3, 1.2], "normal_jump_deg": 20.0, "cgal": "5.5.1"}
BETTER = {**OURS, "dihedral_deg": [25.0, 140.0], "surface_mm": [0.1, 0.5], "normal_jump_deg": 5.0, "cgal": "5.5.1"}


def row(cgal, weights):
    return {"spacing_mm": [1.0, 1.0, 2.0], "ours": OURS, "cgal": cgal, "cgal_weights": weights, "date": "2026-01-01"}


def runs_until_found(count_of, first, wanted):
    """Runs that the search needs until the count is within 5 %."""
    tried, size = {}, first
    for number in range(1, 9):
        tried[size] = count_of(size)
        if tried[size] is not None and compare_peers.off(tried[size], wanted) <= 0.05:
            return number
        size = compare_peers.next_size(tried, wanted)
    return None


class Search(unittest.TestCase):
    def test_finds_the_size_within_eight_runs(self):
        laws = {"volume": lambda h: int(3e5 * h**-3), "surface": lambda h: int(3e5 * h**-2),
                "both": lambda h: int(1e5 * h**-3 + 2e5 * h**-1), "a floor that sizes do not move": lambda h: int(2e4 + 1e5 * h**-3)}
        for name, law in laws.items():
            for first in (0.3, 1.0, 4.0):
                with self.subTest(law=name, first=first):
                    self.assertIsNotNone(runs_until_found(law, first, 40_000))

    def test_grows_the_size_after_a_run_without_end(self):
        self.assertGreater(compare_peers.next_size({1.0: None}, 1000), 1.0)
        self.assertIsNotNone(runs_until_found(lambda h: None if h < 0.9 else int(1e5 * h**-3), 0.5, 20_000))

    def test_stays_between_a_size_too_small_and_one_too_large(self):
        size = compare_peers.next_size({1.0: 2000, 2.0: 900}, 1000)
        self.assertTrue(1.0 < size < 2.0)


class Page(unittest.TestCase):
    def test_names_what_a_peer_is_better_at(self):
        self.assertEqual(compare_peers.better_at(WORSE, OURS), [])
        self.assertEqual(compare_peers.better_at(BETTER, OURS), ["smoother", "nearer", "better-angled"])
        self.assertEqual(compare_peers.better_at({**WORSE, "surface_mm": [0.1, 3.0]}, OURS), ["nearer"])

    def test_owns_up_to_a_peer_that_wins(self):
        self.assertIn("On no image", compare_peers.page({"a.nrrd": row(WORSE, WORSE)}))
        lost = compare_peers.page({"a.nrrd": row(WORSE, BETTER)})
        self.assertNotIn("On no image", lost)
        self.assertIn("CGAL, weights on a", lost)

    def test_shows_failures_and_counts_that_differ(self):
        text = compare_peers.page({"a.nrrd": row({"failed": "no mesh in 600 s"}, {**WORSE, "tets": 1200})})
        self.assertIn("no mesh in 600 s", text)
        self.assertIn("1,200 (!)", text)

    def test_shows_peers_beside_a_failure_of_ours(self):
        failed = {**row(WORSE, BETTER), "ours": {"failed": "no mesh in 600 s"}}
        text = compare_peers.page({"a.nrrd": failed})
        self.assertIn("no mesh in 600 s", text)
        self.assertIn("5.0–170.0", text)

    def test_prints_broken_promises_in_bold(self):
        kept = compare_peers.promises_table({"a.nrrd": row(WORSE, WORSE)})
        self.assertNotIn("**", kept)
        broken = row(WORSE, WORSE)
        broken["ours"] = {**OURS, "dihedral_deg": [19.9, 150.0]}
        self.assertIn("**19.9–150.0**", compare_peers.promises_table({"a.nrrd": broken}))

    def test_rows_are_of_one_width(self):
        text = compare_peers.comparison_table({"a.nrrd": row({"failed": "out of | memory"}, WORSE)})
        self.assertEqual(len({line.count("|") for line in text.strip().splitlines()}), 1)


class Tools(unittest.TestCase):
    def test_worst_is_of_the_largest_magnitude(self):
        self.assertEqual(mesh_figures.worst([1.0, -3.0, 2.0]), -3.0)
        self.assertIsNone(mesh_figures.worst([]))
        self.assertIsNone(mesh_figures.worst([1.0, None]))

    def test_replaces_what_stands_between_the_marks(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "page.md")
            path.write_text("head\n<b>\nold\n<e>\ntail\n", encoding="utf-8")
            for text in ("new", "newer\n", ""):
                pages.replace_between(path, "<b>", "<e>", text)
                self.assertEqual(path.read_text(encoding="utf-8"), f"head\n<b>\n{text.strip()}\n<e>\ntail\n".replace("\n\n", "\n"))
            with self.assertRaises(ValueError):
                pages.replace_between(path, "<b>", "<missing>", "new")

    def test_a_run_is_killed_in_time(self):
        with tempfile.TemporaryDirectory() as folder:
            begin = time.monotonic()
            done = measured_run.run_limited(["sleep", "60"], pathlib.Path(folder, "log"), timeout_s=0.3)
            self.assertTrue(done.timed_out)
            self.assertLess(time.monotonic() - begin, 30)

    def test_a_run_ends_as_it_ends(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log")
            done = measured_run.run_limited([sys.executable, "-c", "import sys; print('out'); sys.exit(3)"], log, timeout_s=60)
            self.assertEqual((done.status, done.timed_out), (3, False))
            self.assertEqual(log.read_text(encoding="utf-8"), "out\n")

    def test_a_run_has_no_more_memory_than_allowed(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", "bytearray(2 * 2**30)"]
            done = measured_run.run_limited(command, pathlib.Path(folder, "log"), memory_gib=1)
            self.assertNotEqual(done.status, 0)


if __name__ == "__main__":
    unittest.main()
