#include "lattice/tet_map.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace anatomesh {
namespace {

TEST(TetMap, KnowsWhatAMapKnows) {
  std::mt19937 random(3);
  TetMap<int> flat;
  for (int round = 0; round < 4; ++round) {
    flat.clear();
    std::map<TetId, int> map;
    for (int n = 0; n < 3000; ++n) {
      const auto t = static_cast<TetId>(random() % (round % 2 == 0 ? 100 : 1000000));
      EXPECT_EQ(flat[t], map[t]);
      flat[t] += n;
      map[t] += n;
    }
    EXPECT_EQ(flat.size(), map.size());
    std::map<TetId, int> listed;
    flat.for_each([&](TetId t) { ++listed[t]; });
    EXPECT_EQ(listed.size(), map.size());
    for (const auto& [t, value] : map) {
      EXPECT_EQ(flat[t], value);
      EXPECT_EQ(listed[t], 1);
    }
  }
}

}  // namespace
}  // namespace anatomesh
