# The two commands of this project, on Debian 12 as root or as a user with sudo:
#   make demo     install, build, mesh a brain atlas of 116 tissues, show how good the mesh is
#   make test     install, build, run all tests
.DEFAULT_GOAL := help
.PHONY: help packages build bench demo test asan fuzz check-style clean

JOBS ?= $(shell nproc)
PYTHON ?= /usr/bin/python3
ATLAS := /usr/share/mricron/templates/aal.nii.gz
PROGRAM := build/release/bin/anatomesh
# Images that `make bench` runs from file to file beside CGAL.
BENCH_IMAGES ?= $(ATLAS)
FUZZ_SECONDS ?= 600

help:
	@echo "make demo         mesh a brain atlas of 116 tissues into demo/, with tables and a picture"
	@echo "make test         build with warnings as errors and run all tests"
	@echo "make build        build the program: $(PROGRAM)"
	@echo "make bench        measure the time of each stage, and of the whole way beside CGAL; writes docs/speed.md"
	@echo "make asan         run the library's tests under the address and undefined-behaviour sanitizers"
	@echo "make fuzz         read damaged mesh files under the sanitizers for FUZZ_SECONDS ($(FUZZ_SECONDS))"
	@echo "make check-style  check the format and the layers of the sources"
	@echo "make clean        remove build/ and demo/"
	@echo "Missing Debian packages are installed first (as root, or with sudo)."

packages:
	@tools/install_packages.sh

build: packages
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target anatomesh
	@echo "next: $(PROGRAM) mesh IMAGE -o MESH.vtu, or make demo"

demo: packages
	cmake --preset release
	cmake --build --preset release -j $(JOBS) --target anatomesh
	@mkdir -p demo
	$(PROGRAM) mesh $(ATLAS) -o demo/aal.vtu
	$(PROGRAM) check demo/aal.vtu --image $(ATLAS) --json demo/aal.json
	$(PYTHON) tools/render_mesh.py demo/aal.vtu demo/aal.png
	@echo "next: look at demo/aal.png, open demo/aal.vtu in ParaView, or mesh an image of your own:"
	@echo "      $(PROGRAM) mesh IMAGE -o MESH.vtu"

test: packages
	cmake --preset ci
	cmake --build --preset ci -j $(JOBS)
	$(MAKE) --no-print-directory asan
	ctest --preset ci -j $(JOBS)
	@echo "next: make demo, or read CONTRIBUTING.md before a change"

bench:
	@tools/install_packages.sh libcgal-dev python3-matplotlib
	cmake --preset release -DANATOMESH_BUILD_PEERS=ON
	cmake --build --preset release -j $(JOBS) --target anatomesh bench_stages cgal_mesh_3
	benchmarks/file_to_file.py $(BENCH_IMAGES) --cgal --page docs/speed.md
	benchmarks/suite.py
	benchmarks/instructions.py
	@echo "next: look at docs/speed.md"

asan: packages
	cmake --preset asan
	cmake --build --preset asan -j $(JOBS)
	ctest --preset asan -j $(JOBS)

fuzz: packages
	cmake --preset asan
	cmake --build --preset asan -j $(JOBS) --target fuzz_mesh_files
	ASAN_OPTIONS=max_allocation_size_mb=2048 \
	  build/asan/bin/fuzz_mesh_files build/asan/damaged $(FUZZ_SECONDS)

check-style: packages
	tools/check_style.sh
	$(PYTHON) tools/check_layers.py
	@echo "next: make test"

clean:
	rm -rf build demo
	@echo "next: make build"
