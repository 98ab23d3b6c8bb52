// Damaged HDF5 beside a good XDMF file. On some of these libhdf5 1.10 crashes.
#include <gtest/gtest.h>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/damage.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {
namespace {

class Hdf5Damage : public IoTest {
 protected:
  Hdf5Damage() {
    TetMesh mesh;
    for (int n = 0; n < 40; ++n) mesh.points_mm.push_back({n / 3.0, (n % 2) * 1.1, (n % 3) / 7.0});
    for (VertexId n = 0; n + 3 < 40; ++n) {
      mesh.tets.push_back({n, n + 1, n + 2, n + 3});
      mesh.labels.push_back(n / 10 + 1);
    }
    write_mesh(in_folder("mesh.xdmf"), mesh);
    whole_ = bytes_of(in_folder("mesh.h5"));
  }

  TetMesh read_with(const std::string& bytes) const {
    put("mesh.h5", bytes);
    return read_mesh(in_folder("mesh.xdmf"));
  }

  void expect_read_or_refused(const std::string& bytes) const {
    try {
      const TetMesh mesh = read_with(bytes);
      EXPECT_EQ(mesh.tets.size(), 37U);
      EXPECT_EQ(mesh.labels.size(), 37U);
    } catch (const Error& error) {
      EXPECT_SAYS(std::string(error.what()), "mesh.");
    }
  }

  std::string whole_;
};

TEST_F(Hdf5Damage, AnyIsReadOrRefused) {
  for (const unsigned crashing : {2U, 39U}) {
    std::mt19937 random(crashing);
    for (int trial = 0; trial < 400; ++trial) expect_read_or_refused(damaged(whole_, random));
  }
}

// libhdf5 1.10 divides by both.
TEST_F(Hdf5Damage, ChunksWithoutSizeAreRefused) {
  // A layout message of version 3: chunked, three dimensions; then an address and the dimensions.
  const std::string head = {8, 0, 24, 0, 0, 0, 0, 0, 3, 2, 3};
  const std::size_t at = whole_.find(head);
  ASSERT_NE(at, std::string::npos);
  for (const std::size_t damaged_at : {at + 10, at + 19}) {
    std::string bytes = whole_;
    bytes[damaged_at] = 0;
    EXPECT_SAYS(message_of<IoError>("mesh.h5", [&] { read_with(bytes); }), "damaged");
  }
}

TEST_F(Hdf5Damage, CutFilesAreRefused) {
  for (std::size_t part = 1; part < 40; ++part) {
    message_of<IoError>("mesh.h5", [&] { read_with(whole_.substr(0, part * whole_.size() / 40)); });
  }
}

}  // namespace
}  // namespace anatomesh::testing
