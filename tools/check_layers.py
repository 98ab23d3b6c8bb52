#!/usr/bin/env python3
"""Checks the floors of the source tree: a file includes its own folder and lower floors, never upward and
never a sibling folder of the same floor; each outside library stays in the one folder that fences it.

usage: check_layers.py [ROOT]      exit status 1 when anything is out of place
"""
import pathlib
import re
import sys

FLOORS = {"base": 0, "image": 1, "mesh": 2, "lattice": 3, "boundary": 3, "fem": 3, "deform": 4, "assess": 4,
          "pipeline": 5, "io": 6}

# Floor from which a public header may be included; a header that is not named here is of floor 0 (plain types).
PUBLIC_FLOORS = {"label_list.h": 1, "interfaces.h": 2, "quadratic.h": 2, "assess.h": 4, "image_to_mesh.h": 5, "mesh_request.h": 5,
                 "remesher.h": 5, "io.h": 6}

# Folders that see nothing of the library but its public headers.
OUTSIDE = ("apps", "bindings", "plugins", "examples", "benchmarks")
# But for this one, which measures the floors one by one and, like the tests, sees all of them.
SEES_ALL = "benchmarks/stages"

# Outside libraries: pattern of the include, and the folders that may use it.
FENCES = [
    ("oneTBB", re.compile(r"^(tbb|oneapi)/"), ("src/base", "benchmarks/cgal_mesh_3")),
    ("Eigen", re.compile(r"^(unsupported/)?Eigen/"), ("src/fem",)),
    ("ITK", re.compile(r"^itk"), ("src/io", "plugins")),
    ("VTK", re.compile(r"^vtk"), ("src/io", "plugins")),
    ("HDF5", re.compile(r"^hdf5"), ("src/io",)),
    ("pugixml", re.compile(r"^pugi"), ("src/io",)),
    ("CGAL", re.compile(r"^CGAL/"), ("benchmarks",)),
    ("CLI11", re.compile(r"^CLI/"), ("apps", "benchmarks")),
    ("JSON", re.compile(r"^nlohmann/"), ("apps", "benchmarks")),
    ("pybind11", re.compile(r"^pybind11/"), ("bindings/python",)),
    ("SOFA", re.compile(r"^sofa/"), ("plugins/sofa", "benchmarks/sofa_steps")),
    ("fmt", re.compile(r"^(fmt|spdlog)/"), ("apps",)),
]

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
SOURCES = {".h", ".hpp", ".cpp", ".cc", ".cxx", ".hxx"}


def includes(path):
    """(line number, quoted, included path) of every include of a file."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = INCLUDE.match(line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def fence_fault(place, name):
    for library, pattern, allowed in FENCES:
        if pattern.match(name) and not any(place == a or place.startswith(a + "/") for a in allowed):
            return f"{library} may be included only in {', '.join(allowed)}"
    return None


def public_header_fault(quoted, name):
    """A header of include/anatomesh shows the standard library and its fellows only."""
    if quoted:
        return None if name.startswith("anatomesh/") else "a public header includes only anatomesh/ and the standard library"
    return "a public header includes only anatomesh/ and the standard library" if re.search(r"[./]", name) else None


def source_fault(folder, quoted, name):
    """A file of src/FOLDER."""
    if not quoted:
        return None
    head, _, rest = name.partition("/")
    own = FLOORS[folder]
    if head == "anatomesh":
        floor = PUBLIC_FLOORS.get(rest, 0)
        return None if floor <= own else f"{name} belongs to floor {floor}, above {folder} (floor {own})"
    if head == folder:
        return None
    if head not in FLOORS:
        return f'"{name}" is neither of a floor nor public'
    if FLOORS[head] < own:
        return None
    relation = "a sibling of" if FLOORS[head] == own else "above"
    return f"{head} (floor {FLOORS[head]}) is {relation} {folder} (floor {own})"


def outside_fault(folder, quoted, name):
    """A file of apps, bindings, plugins ...: public headers and its own folder."""
    if not quoted or name.split("/")[0] not in FLOORS:
        return None
    return f"{folder} sees only anatomesh/*.h, not {name}"


def faults(root):
    """Every include that is out of place, as 'file:line: why'."""
    for path in sorted(p for p in root.rglob("*") if p.suffix in SOURCES and p.is_file()):
        place = path.relative_to(root)
        top = place.parts[0]
        if top not in ("include", "src") + OUTSIDE:
            continue
        if top == "src" and (len(place.parts) < 3 or place.parts[1] not in FLOORS):
            yield f"{place}: src/{place.parts[1]} has no floor in tools/check_layers.py"
            continue
        for number, quoted, name in includes(path):
            fault = fence_fault(place.parent.as_posix(), name)
            if not fault and top == "include":
                fault = public_header_fault(quoted, name)
            elif not fault and top == "src":
                fault = source_fault(place.parts[1], quoted, name)
            elif not fault and place.parent.as_posix() != SEES_ALL:
                fault = outside_fault(top, quoted, name)
            if fault:
                yield f"{place}:{number}: {fault}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    found = list(faults(root))
    for fault in found:
        print(fault)
    print(f"layers: {len(found)} include(s) out of place" if found else "layers: every include is in place")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
