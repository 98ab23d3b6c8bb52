#!/usr/bin/env python3
"""Progress, cancellation, threads and errors of calls that take long."""
import os
import signal
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

import anatomesh
import numpy as np
from support import bars, nested_balls

# Takes some ten seconds when nobody stops it.
LONG = {"bcc_size_mm": 3, "min_size_mm": 0.4, "fidelity": 1}


class Progress(unittest.TestCase):
    def test_rises_to_the_end_on_the_calling_thread(self):
        reports, threads = [], set()

        def progress(stage, fraction):
            reports.append((stage, fraction))
            threads.add(threading.get_ident())

        anatomesh.mesh(nested_balls(), progress=progress)
        fractions = [fraction for _, fraction in reports]
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(reports[-1], ("finish", 1.0))
        self.assertEqual(threads, {threading.get_ident()})

    def test_is_told_of_an_assessment(self):
        reports = []
        anatomesh.mesh(nested_balls()).assess(nested_balls(), progress=lambda *report: reports.append(report))
        self.assertTrue(reports)


class Cancelling(unittest.TestCase):
    def stops_soon(self, error, message="", **arguments):
        begin = time.monotonic()
        with self.assertRaisesRegex(error, message):
            anatomesh.mesh(bars(96), **LONG, **arguments)
        self.assertLess(time.monotonic() - begin, 5)

    def test_by_returning_false(self):
        self.stops_soon(anatomesh.Cancelled, progress=lambda stage, fraction: fraction < 0.06)

    def test_by_raising(self):
        def progress(stage, fraction):
            raise KeyError("enough")

        self.stops_soon(KeyError, "enough", progress=progress)

    def test_by_ctrl_c(self):
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        self.stops_soon(KeyboardInterrupt)
        timer.join()

    def test_is_not_what_none_or_zero_say(self):
        for answer in (None, True, 0, ""):
            anatomesh.mesh(nested_balls(), progress=lambda stage, fraction: answer)


class Threads(unittest.TestCase):
    def test_make_two_meshes_at_once(self):
        images = [nested_balls(), bars(40), np.asfortranarray(nested_balls()), bars(40)]
        alone = [anatomesh.mesh(image) for image in images]
        with ThreadPoolExecutor(len(images)) as pool:
            together = list(pool.map(anatomesh.mesh, images))
        for one, other in zip(alone, together):
            self.assertEqual(one.points.tobytes(), other.points.tobytes())
            self.assertEqual(one.tets.tobytes(), other.tets.tobytes())

    def test_go_on_while_one_meshes(self):
        done, turns = threading.Event(), 0

        def mesh():
            anatomesh.mesh(bars(48))
            done.set()

        thread = threading.Thread(target=mesh)
        thread.start()
        while not done.wait(0.001):
            turns += 1
        thread.join()
        self.assertGreater(turns, 20)

    def test_one_that_is_cancelled_leaves_the_other_alone(self):
        with ThreadPoolExecutor(2) as pool:
            stopped = pool.submit(anatomesh.mesh, bars(96), progress=lambda *_: False, **LONG)
            finished = pool.submit(anatomesh.mesh, nested_balls())
            self.assertRaises(anatomesh.Cancelled, stopped.result)
            self.assertGreater(len(finished.result().tets), 0)


class Errors(unittest.TestCase):
    def test_are_kinds_of_what_python_has(self):
        kinds = [
            (anatomesh.InvalidOption, anatomesh.InvalidInput),
            (anatomesh.InvalidInput, ValueError),
            (anatomesh.MeshingFailed, RuntimeError),
            (anatomesh.Cancelled, anatomesh.Error),
            (anatomesh.InvalidInput, anatomesh.Error),
        ]
        for kind, base in kinds:
            self.assertTrue(issubclass(kind, base))
        self.assertFalse(issubclass(anatomesh.Cancelled, ValueError))

    def test_of_a_mesh_that_cannot_be_made(self):
        with self.assertRaises(anatomesh.MeshingFailed):
            anatomesh.mesh(nested_balls(), max_elements=1)
        with self.assertRaisesRegex(anatomesh.InvalidInput, "GiB of memory"):
            anatomesh.mesh(nested_balls(), max_memory_gib=1e-6)

    def test_of_progress_that_cannot_be_called(self):
        with self.assertRaises(TypeError):
            anatomesh.mesh(nested_balls(), progress=3)


if __name__ == "__main__":
    unittest.main()
