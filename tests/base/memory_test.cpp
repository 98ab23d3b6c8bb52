#include "base/memory.h"

#include <gtest/gtest.h>

namespace anatomesh {
namespace {

TEST(AvailableMemory, IsThatOfAComputer) {
  const double gib = available_memory_gib();
  EXPECT_GE(gib, 0);
  EXPECT_LT(gib, 1e6);
}

}  // namespace
}  // namespace anatomesh
