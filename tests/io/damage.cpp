#include "io/damage.h"

#include <algorithm>
#include <cstddef>

namespace anatomesh::testing {

std::string damaged(std::string bytes, std::mt19937& random) {
  for (std::size_t left = 1 + random() % 5; left > 0 && !bytes.empty(); --left) {
    const std::size_t at = random() % bytes.size(), count = 1 + random() % 20;
    switch (random() % 8) {
      case 0:
        bytes.replace(at, std::min<std::size_t>(8, bytes.size() - at), 8, '\xff');
        break;
      case 1:
        bytes.erase(at, count);
        break;
      case 2:
        bytes.insert(at, std::string(bytes, at, count));
        break;
      case 3:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      default:
        bytes[at] = static_cast<char>(random());
    }
  }
  return bytes;
}

}  // namespace anatomesh::testing
