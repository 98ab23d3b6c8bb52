#include <gtest/gtest.h>
#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/core/logging/PerComponentLoggingMessageHandler.h>
#include <sofa/helper/logging/CountingMessageHandler.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/simulation/Node.h>
#include <sofa/simulation/Simulation.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sofa_session.h"

namespace anatomesh::simulation {
namespace {

using sofa::helper::logging::MainCountingMessageHandler;
using sofa::helper::logging::Message;
using sofa::helper::logging::MessageDispatcher;
using State = sofa::component::statecontainer::MechanicalObject<sofa::defaulttype::Vec3Types>;

/// A scene of the plugin, which has left no error so far.
class Scene {
 public:
  explicit Scene(const std::string& name) {
    start_sofa();
    MessageDispatcher::addHandler(&MainCountingMessageHandler::getInstance());
    MainCountingMessageHandler::getInstance().reset();
    root_ = sofa::simulation::node::load(std::string(ANATOMESH_SCENES) + "/" + name);
    if (root_) sofa::simulation::node::initRoot(root_.get());
  }
  ~Scene() {
    if (root_) sofa::simulation::node::unload(root_);
    MessageDispatcher::rmHandler(&MainCountingMessageHandler::getInstance());
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  bool is_loaded() const { return root_ != nullptr; }
  int errors() const {
    auto& counts = MainCountingMessageHandler::getInstance();
    return counts.getMessageCountFor(Message::Error) + counts.getMessageCountFor(Message::Fatal);
  }
  void step(int steps) {
    for (int s = 0; s < steps; ++s) sofa::simulation::node::animate(root_.get());
  }
  const State& state() const {
    State* found = nullptr;
    root_->getTreeObject(found);
    return *found;
  }

 private:
  sofa::simulation::NodeSPtr root_;
};

/// Largest length; not finite where one of them is not.
double largest(const sofa::type::vector<sofa::type::Vec3>& vectors) {
  double most = 0;
  for (const auto& v : vectors) {
    if (!std::isfinite(v.norm())) return v.norm();
    most = std::max(most, v.norm());
  }
  return most;
}

double largest_displacement(const State& state) {
  auto moved = state.x.getValue();
  const auto& rest = state.x0.getValue();
  for (std::size_t p = 0; p < moved.size(); ++p) moved[p] -= rest[p];
  return largest(moved);
}

TEST(Scenes, BrainComesToRest) {
  Scene scene("brain.scn");
  ASSERT_TRUE(scene.is_loaded());
  scene.step(10);
  const double early = largest(scene.state().v.getValue());
  scene.step(90);
  const double late = largest(scene.state().v.getValue()), sag = largest_displacement(scene.state());
  EXPECT_GT(scene.state().x.getValue().size(), 1000u);
  EXPECT_TRUE(std::isfinite(early) && std::isfinite(late) && std::isfinite(sag));
  EXPECT_GT(early, 1);
  EXPECT_LT(late, 0.1);  // mm/s
  EXPECT_GT(sag, 0.5);   // mm
  EXPECT_LT(sag, 30);
  EXPECT_EQ(scene.errors(), 0);
}

TEST(Scenes, Figure4FollowsItsTetrahedra) {
  Scene scene("figure4.scn");
  ASSERT_TRUE(scene.is_loaded());
  scene.step(10);
  EXPECT_TRUE(std::isfinite(largest_displacement(scene.state())));
  EXPECT_GT(largest_displacement(scene.state()), 0);
  EXPECT_EQ(scene.errors(), 0);
}

TEST(Scenes, ToolPullsTheMalformation) {
  Scene scene("malformation.scn");
  ASSERT_TRUE(scene.is_loaded());
  scene.step(50);
  EXPECT_NEAR(largest_displacement(scene.state()), 2.5, 0.5);  // 5 mm a second, for half a second
  EXPECT_EQ(scene.errors(), 0);
}

}  // namespace
}  // namespace anatomesh::simulation
