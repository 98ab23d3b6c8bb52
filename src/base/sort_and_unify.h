// Lists as sets.
#pragma once

#include <algorithm>
#include <vector>

namespace anatomesh {

/// In ascending order, each once.
template <class T>
void sort_and_unify(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace anatomesh
