// Steps of a SOFA scene: how long they take, how many iterations the conjugate gradient makes, where the vertices end.
#include <sofa/component/init.h>
#include <sofa/component/linearsolver/iterative/CGLinearSolver.h>
#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/Node.h>
#include <sofa/simulation/Simulation.h>
#include <sofa/simulation/graph/init.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using State = sofa::component::statecontainer::MechanicalObject<sofa::defaulttype::Vec3Types>;
using Vectors = sofa::type::vector<sofa::type::Vec3>;

void load_plugins() {
  sofa::component::init();
  sofa::simulation::graph::init();
  sofa::helper::system::PluginRepository.addFirstPath(SOFA_COMPONENTS);
  sofa::helper::system::PluginManager::getInstance().loadPluginByPath(ANATOMESH_PLUGIN);
  sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin("Anatomesh");
}

/// Largest length; infinite where one of them is not finite.
double largest(const Vectors& vectors) {
  double most = 0;
  for (const auto& v : vectors) most = std::isfinite(v.norm()) ? std::max(most, v.norm()) : HUGE_VAL;
  return most;
}

double largest_displacement(const State& state) {
  Vectors moved = state.x.getValue();
  const Vectors& rest = state.x0.getValue();
  for (std::size_t p = 0; p < moved.size(); ++p) moved[p] -= rest[p];
  return largest(moved);
}

/// Of the last solution, as the solver's graph of residuals has them.
std::size_t iterations_of(sofa::core::objectmodel::BaseObject& solver) {
  using Graph = std::map<std::string, sofa::type::vector<SReal>>;
  const auto* graph = dynamic_cast<sofa::core::objectmodel::Data<Graph>*>(solver.findData("graph"));
  if (graph == nullptr || !graph->getValue().contains("Denominator")) return 0;
  return graph->getValue().at("Denominator").size();
}

void write_points(const std::string& path, const State& state) {
  std::ofstream file(path);
  file.precision(9);
  for (const auto& p : state.x.getValue()) file << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Steps of a SOFA scene; one line of JSON");
  std::string scene, points;
  int steps = 100;
  app.add_option("scene", scene)->required();
  app.add_option("--steps", steps)->capture_default_str();
  app.add_option("--points", points, "text file for the vertices at the end");
  CLI11_PARSE(app, argc, argv);

  load_plugins();
  const auto root = sofa::simulation::node::load(scene);
  if (!root) return 2;
  sofa::simulation::node::initRoot(root.get());
  State* state = nullptr;
  root->getTreeObject(state);
  sofa::core::behavior::LinearSolver* solver = nullptr;
  root->getTreeObject(solver);
  if (state == nullptr || solver == nullptr || state->x.getValue().size() < 2) return 2;

  std::size_t iterations = 0, most = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int s = 0; s < steps; ++s) {
    sofa::simulation::node::animate(root.get());
    const std::size_t now = iterations_of(*solver);
    iterations += now;
    most = std::max(most, now);
    if (largest_displacement(*state) > 1e4) break;  // it has burst
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double speed = largest(state->v.getValue()), sag = largest_displacement(*state);
  if (!points.empty()) write_points(points, *state);
  const nlohmann::json row = {{"steps_s", steps / seconds},
                              {"iterations", static_cast<double>(iterations) / steps},
                              {"most_iterations", most},
                              {"speed_mm_s", std::isfinite(speed) ? speed : 1e300},
                              {"sag_mm", std::isfinite(sag) ? sag : 1e300}};
  std::printf("\n%s\n", row.dump().c_str());
  return 0;
}
