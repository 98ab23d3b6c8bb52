// From an image file to a mesh file: mesh_file IMAGE MESH
#include <anatomesh/errors.h>
#include <anatomesh/image_to_mesh.h>
#include <anatomesh/io.h>

#include <cstdio>

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "usage: %s IMAGE MESH\n", arguments[0]);
    return 2;
  }
  try {
    const anatomesh::ImageFile file = anatomesh::read_label_image(arguments[1]);
    const anatomesh::Result result = anatomesh::image_to_mesh(file.image);
    for (const std::string& warning : result.warnings) std::fprintf(stderr, "%s\n", warning.c_str());
    anatomesh::write_mesh(arguments[2], result.mesh);
    std::printf("%zu tetrahedra\n", result.mesh.tets.size());
  } catch (const anatomesh::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
