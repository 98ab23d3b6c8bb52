// Damaged binary files.
#pragma once

#include <random>
#include <string>

namespace anatomesh::testing {

/// The bytes with a few of them changed, set to large numbers, taken out or doubled. The same for the same random
/// state.
std::string damaged(std::string bytes, std::mt19937& random);

}  // namespace anatomesh::testing
