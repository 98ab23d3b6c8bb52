#include "sofa_session.h"

#include <gtest/gtest.h>
#include <sofa/component/init.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/core/logging/PerComponentLoggingMessageHandler.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/helper/system/PluginManager.h>
#include <sofa/simulation/graph/init.h>
#include <stdlib.h>

#include <stdexcept>

namespace anatomesh::simulation {
namespace {

using sofa::core::objectmodel::ComponentState;
using sofa::helper::logging::MainPerComponentLoggingMessageHandler;
using sofa::helper::logging::Message;
using sofa::helper::logging::MessageDispatcher;
using sofa::helper::system::PluginManager;

bool load_plugins() {
  sofa::component::init();
  sofa::simulation::graph::init();
  sofa::helper::system::PluginRepository.addFirstPath(SOFA_COMPONENTS);
  if (PluginManager::getInstance().loadPluginByPath(ANATOMESH_PLUGIN) ==
      PluginManager::PluginLoadStatus::INVALID_LOADING)
    throw std::runtime_error("the plugin cannot be loaded");
  sofa::core::ObjectFactory::getInstance()->registerObjectsFromPlugin("Anatomesh");
  MessageDispatcher::addHandler(&MainPerComponentLoggingMessageHandler::getInstance());
  return true;
}

}  // namespace

void start_sofa() { [[maybe_unused]] static const bool started = load_plugins(); }

LabelImage two_balls(int side) {
  LabelImage image;
  image.size.fill(static_cast<std::size_t>(side));
  image.spacing_mm = {1, 1, 1.25};
  image.origin_mm = {10, -20, 30};
  const double middle = 0.5 * (side - 1);
  for (int k = 0; k < side; ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const double x = i - middle, y = j - middle, z = k - middle;
        const double square = (x * x + y * y + z * z) / (middle * middle);
        image.voxels.push_back(square < 0.15 ? 7 : square < 0.7 ? 1 : 0);
      }
    }
  }
  return image;
}

ImageToTetrahedralMesh::SPtr mesher_of(const LabelImage& image) {
  start_sofa();
  const auto mesher = sofa::core::objectmodel::New<ImageToTetrahedralMesh>();
  const auto unsigned_of = [](std::size_t size) { return static_cast<unsigned>(size); };
  mesher->d_dimensions.setValue({unsigned_of(image.size[0]), unsigned_of(image.size[1]), unsigned_of(image.size[2])});
  mesher->d_spacing.setValue({image.spacing_mm.x, image.spacing_mm.y, image.spacing_mm.z});
  mesher->d_origin.setValue({image.origin_mm.x, image.origin_mm.y, image.origin_mm.z});
  TetrahedralMeshEngine::Values<Label> voxels;
  voxels.assign(image.voxels.begin(), image.voxels.end());
  mesher->d_voxels.setValue(voxels);
  return mesher;
}

void set(sofa::core::objectmodel::BaseObject& component, const std::string& data, const std::string& text) {
  sofa::core::BaseData* found = component.findData(data);
  ASSERT_NE(found, nullptr) << data;
  ASSERT_TRUE(found->read(text)) << data << " = " << text;
}

bool is_valid(const sofa::core::objectmodel::BaseObject& component) {
  return component.d_componentState.getValue() == ComponentState::Valid;
}

std::string errors_of(const sofa::core::objectmodel::BaseObject& component) {
  return component.getLoggedMessagesAsString({Message::Error});
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "anatomesh_sofa_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() { std::filesystem::remove_all(path_); }

}  // namespace anatomesh::simulation
