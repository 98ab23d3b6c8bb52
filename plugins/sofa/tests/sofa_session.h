// SOFA with the plugin in this process, and images to mesh in it.
#pragma once

#include <Anatomesh/ImageToTetrahedralMesh.h>
#include <sofa/core/objectmodel/BaseObject.h>

#include <filesystem>
#include <string>

#include "anatomesh/label_image.h"

namespace anatomesh::simulation {

/// Starts SOFA and loads the plugin, once a process; messages stay with their component from then on.
void start_sofa();

/// A ball of label 1 with a core of label 7.
LabelImage two_balls(int side = 24);

/// A component with that image as its Data, not initialised.
ImageToTetrahedralMesh::SPtr mesher_of(const LabelImage& image);

/// Sets a Data by its name and the text that a scene would have.
void set(sofa::core::objectmodel::BaseObject& component, const std::string& data, const std::string& text);

bool is_valid(const sofa::core::objectmodel::BaseObject& component);

/// The error messages of a component, in one text.
std::string errors_of(const sofa::core::objectmodel::BaseObject& component);

/// An empty folder that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace anatomesh::simulation
