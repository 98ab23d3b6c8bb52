#include "base/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace anatomesh {
namespace {

constexpr double kKibPerGib = 1024.0 * 1024, kBytesPerGib = 1024 * kKibPerGib;

// First number of a file; negative where there is none (as in the "max" of an unlimited control group).
double number_in(const char* path) {
  double value = -1;
  std::ifstream(path) >> value;
  return value;
}

double free_of_machine_gib() {
  std::ifstream meminfo("/proc/meminfo");
  std::string name;
  double kib = 0;
  while (meminfo >> name >> kib) {
    if (name == "MemAvailable:") return kib / kKibPerGib;
    meminfo.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

}  // namespace

double available_memory_gib() {
  const double limit = number_in("/sys/fs/cgroup/memory.max"), used = number_in("/sys/fs/cgroup/memory.current");
  const double machine = free_of_machine_gib();
  if (limit <= 0 || used < 0) return machine;
  return std::min(machine, std::max(0.0, limit - used) / kBytesPerGib);
}

}  // namespace anatomesh
