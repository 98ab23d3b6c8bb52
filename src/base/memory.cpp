#include "base/memory.h"

#include <fstream>
#include <limits>
#include <string>

namespace anatomesh {

double available_memory_gib() {
  std::ifstream meminfo("/proc/meminfo");
  std::string name;
  double kib = 0;
  while (meminfo >> name >> kib) {
    if (name == "MemAvailable:") return kib / (1024 * 1024);
    meminfo.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

}  // namespace anatomesh
