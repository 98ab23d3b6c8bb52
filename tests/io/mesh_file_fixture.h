// What the tests of mesh files share.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"
#include "support/test_meshes.h"

namespace anatomesh::testing {

/// A test of mesh files under any name.
class MeshFileTest : public IoTest {
 protected:
  TetMesh mesh_in(const std::string& name, const std::string& bytes) const { return read_mesh(put(name, bytes)); }

  /// The message about a file of these bytes, which cannot be read.
  template <typename Expected>
  std::string refused(const std::string& name, const std::string& bytes) const {
    const auto file = put(name, bytes);
    return message_of<Expected>(file, [&] { read_mesh(file); });
  }

  /// The bytes that the mesh is written as.
  std::string written(const std::string& name, const TetMesh& mesh) const {
    write_mesh(in_folder(name), mesh);
    return bytes_of(in_folder(name));
  }
};

/// A test of mesh files under one name.
class NamedMeshFileTest : public MeshFileTest {
 protected:
  explicit NamedMeshFileTest(std::string name) : name_(std::move(name)) {}

  TetMesh read(const std::string& bytes) const { return mesh_in(name_, bytes); }

  template <typename Expected>
  std::string refused(const std::string& bytes) const {
    return MeshFileTest::refused<Expected>(name_, bytes);
  }

  std::string written(const TetMesh& mesh) const { return MeshFileTest::written(name_, mesh); }

 private:
  std::string name_;
};

/// Fails unless they are equal to the last bit.
void expect_same(const TetMesh& actual, const TetMesh& expected);

/// The bytes with some of them, drawn at random, changed.
std::string with_changed_bytes(std::string bytes, int count, std::mt19937& random);

/// Reads a file that may be damaged. Fails unless it is a mesh whose ids are in range, or refused with one of the
/// library's errors; returns its message.
std::string message_of_damaged(const std::filesystem::path& file);

}  // namespace anatomesh::testing
