// cgal_mesh_3: meshes a segmented image with CGAL's Mesh_3, for comparison. Prints one line of JSON.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "anatomesh/io.h"
#include "benchmarks/cgal_mesh_3/cgal_mesher.h"

namespace anatomesh::peers {
namespace {

struct Arguments {
  std::string image, mesh;
  CgalOptions options;
  bool weights = false;
};

void add_options(CLI::App& app, Arguments& a) {
  CgalOptions& o = a.options;
  app.add_option("image", a.image, "segmented image")->required();
  app.add_option("-o,--output", a.mesh, "mesh to write, .vtu or .vtk")->required();
  app.add_option("--facet-angle", o.facet_angle_deg, "degrees")->capture_default_str();
  app.add_option("--facet-size", o.facet_size_mm, "mm")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--facet-distance", o.facet_distance_mm, "mm")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--cell-ratio", o.cell_radius_edge_ratio, "radius over shortest edge")->capture_default_str();
  app.add_option("--cell-size", o.cell_size_mm, "mm")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_flag("--weights", a.weights, "label weights, for smooth surfaces");
  app.add_option("--weights-sigma", o.weights_sigma_mm, "mm; of the weights [the largest voxel spacing]");
  app.add_flag("!--no-optimisers", o.optimise, "no perturbation and no exudation");
  app.add_option("--threads", o.threads, "more than 1: the parallel mesher")->capture_default_str();
  app.add_option("--sliver-bound", o.sliver_bound_deg, "degrees; where the optimisers stop, 0: as far as they can")
      ->capture_default_str();
}

double cpu_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void run(Arguments& a) {
  const auto begin = std::chrono::steady_clock::now();
  check_mesh_writable(a.mesh);
  const LabelImage image = read_label_image(a.image).image;
  const Vec3 s = image.spacing_mm;
  if (!a.weights)
    a.options.weights_sigma_mm = 0;
  else if (a.options.weights_sigma_mm <= 0)
    a.options.weights_sigma_mm = std::max({s.x, s.y, s.z});
  CgalTimes times;
  const TetMesh mesh = mesh_with_cgal(image, a.options, times);
  write_mesh(a.mesh, mesh);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const nlohmann::ordered_json line = {
      {"cgal", cgal_version()},
      {"tets", mesh.tets.size()},
      {"vertices", mesh.points_mm.size()},
      {"wall_s", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()},
      {"cpu_s", cpu_seconds(usage)},
      {"weights_s", times.weights_s},
      {"mesh_s", times.mesh_s},
      {"memory_mb", static_cast<double>(usage.ru_maxrss) / 1024}};
  std::cout << line << '\n';
}

}  // namespace
}  // namespace anatomesh::peers

int main(int argc, char** argv) {
  CLI::App app("Meshes a segmented image with CGAL's Mesh_3");
  anatomesh::peers::Arguments arguments;
  anatomesh::peers::add_options(app, arguments);
  try {
    app.parse(argc, argv);
    anatomesh::peers::run(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "cgal_mesh_3: error: " << error.what() << '\n';
    return 4;
  }
  return 0;
}
