#include <Anatomesh/MeshCache.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <type_traits>

#include "anatomesh/version.h"

namespace anatomesh::simulation {
namespace {

/// FNV-1a of 64 bits (Fowler, Noll and Vo; RFC 9923).
class Hash {
 public:
  template <class... Values>
  void add(const Values&... values) {
    (take(values), ...);
  }

  std::string digits() const {
    std::array<char, 16> text;
    text.fill('0');
    std::array<char, 16> tail{};
    const auto end = std::to_chars(tail.data(), tail.data() + tail.size(), state_, 16).ptr;
    std::copy_backward(tail.data(), end, text.data() + text.size());
    return {text.begin(), text.end()};
  }

 private:
  void take_bytes(const void* begin, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(begin);
    for (std::size_t b = 0; b < size; ++b) state_ = (state_ ^ bytes[b]) * 0x100000001b3U;
  }

  template <class Value>
  requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) void take(const Value& value) {
    take_bytes(&value, sizeof value);
  }
  void take(const Vec3& value) { add(value.x, value.y, value.z); }
  void take(const Material& value) { add(value.young_modulus_pa, value.poisson_ratio); }
  void take(const LabelEntry& value) {
    add(value.name, value.colour.has_value());
    if (value.colour) add(*value.colour);
  }
  template <class First, class Second>
  void take(const std::pair<First, Second>& value) {
    add(value.first, value.second);
  }
  /// Arrays, vectors, maps and texts, with their sizes so that none runs into the next.
  template <class Range>
  requires requires(const Range& range) { range.begin(); }
  void take(const Range& range) {
    add(range.size());
    for (const auto& value : range) take(value);
  }

  std::uint64_t state_ = 0xcbf29ce484222325U;
};

// The bindings name every member, so that a new one does not compile until it is counted in.

void add_image(Hash& hash, const LabelImage& image) {
  const auto& [size, spacing, origin, direction, voxels, names] = image;
  hash.add(size, spacing, origin, direction, voxels, names);
}

void add_lattice(Hash& hash, const LatticeOptions& options) {
  const auto& [bcc_size, min_size, fidelity, fidelity_label, fidelity_stage, max_elements, size_label, elements_across,
               drop_islands, allow_non_manifold] = options;
  hash.add(bcc_size, min_size, fidelity, fidelity_label, fidelity_stage, max_elements, size_label, elements_across,
           drop_islands, allow_non_manifold);
}

void add_deform(Hash& hash, const DeformOptions& options) {
  const auto& [non_connectivity, iterations, min_dihedral, max_dihedral, min_mean_ratio, gradation, material,
               default_material] = options;
  hash.add(non_connectivity, iterations, min_dihedral, max_dihedral, min_mean_ratio, gradation, material,
           default_material);
}

}  // namespace

std::string content_hash(const LabelImage& image, const Options& options) {
  Hash hash;
  hash.add(std::string(version()));
  add_image(hash, image);
  const auto& [lattice, deform, labels, frame, order, threads, max_memory] = options;
  add_lattice(hash, lattice);
  add_deform(hash, deform);
  hash.add(labels, frame, order);  // threads and memory change nothing
  return hash.digits();
}

std::filesystem::path cached_mesh(const std::filesystem::path& folder, const std::string& hash) {
  return folder / (hash + ".vtu");
}

}  // namespace anatomesh::simulation
