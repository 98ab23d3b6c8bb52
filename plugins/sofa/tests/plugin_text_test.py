#!/usr/bin/env python3
"""The plugin as text: what can be checked of it where SOFA is not installed.

The scenes for SofaPython3 make what the scenes in XML do: the same components with the same data in the same nodes. The
component that meshes has a Data for every option of `anatomesh mesh`.

usage: plugin_text_test.py ANATOMESH
"""
import importlib.util
import pathlib
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree

PLUGIN = pathlib.Path(__file__).resolve().parents[1]
SCENES = PLUGIN / "scenes"

# Options about files and the terminal. Force fields take linear tetrahedra, so that there is no order.
NOT_DATA = {"help", "output", "names", "report", "quiet", "verbose", "order"}


class Node:
    """Takes what a scene says to SofaPython3's node."""

    def __init__(self, name):
        self.name, self.contents = name, []

    def addObject(self, component, **data):
        self.contents.append((component, data))

    def addChild(self, name):
        child = Node(name)
        self.contents.append(child)
        return child

    def told(self):
        """The node as nested lists, which can be compared."""
        return [self.name, *(c.told() if isinstance(c, Node) else c for c in self.contents)]


def told_in_xml(node):
    return [node.get("name"), *(told_in_xml(c) if c.tag == "Node" else (c.tag, dict(c.attrib)) for c in node)]


def told_in_python(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    root = Node("root")
    scene.createScene(root)
    return root


class Scenes(unittest.TestCase):
    def test_are_those_in_xml(self):
        scenes = sorted(SCENES.glob("*.scn"))
        self.assertEqual([path.stem for path in scenes], [path.stem for path in sorted(SCENES.glob("*.py"))
                                                          if path.stem != "make_images"])
        for path in scenes:
            with self.subTest(scene=path.stem):
                wanted = xml.etree.ElementTree.parse(path).getroot()
                root = told_in_python(path.with_suffix(".py"))
                self.assertEqual(root.told(), told_in_xml(wanted))
                self.assertEqual(root.dt, float(wanted.get("dt")))
                self.assertEqual(root.gravity, [float(part) for part in wanted.get("gravity").split()])


class Options(unittest.TestCase):
    def test_are_data_of_the_same_names(self):
        said = subprocess.run([sys.argv[-1], "mesh", "--help"], check=True, capture_output=True, text=True).stdout
        options = set(re.findall(r"^ +(?:-\w,)?--([a-z-]+)", said, re.MULTILINE)) - NOT_DATA
        self.assertGreater(len(options), 20)
        sources = "".join(path.read_text(encoding="utf-8") for path in (PLUGIN / "src").rglob("*.cpp"))
        for option in sorted(options):
            name = re.sub(r"-(\w)", lambda part: part[1].upper(), option)
            with self.subTest(option=option):
                self.assertRegex(sources, rf'initData\(\s*&d_{name},[^;]*?"{name}"')


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
