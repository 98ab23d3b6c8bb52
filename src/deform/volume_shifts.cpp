#include "deform/volume_shifts.h"

#include <algorithm>

#include "base/vec.h"

namespace anatomesh {
namespace {

constexpr double kMostShift = 0.15;  // of a voxel
constexpr double kDamping = 0.9;     // what one update brings of what is lacking
constexpr int kSweeps = 50;          // of the solution for the shifts; the next update brings what it leaves

struct Contact {
  TissueId other;
  double area_mm2;
};

// What each tissue encloses, and where it touches which others; the image's border cannot be shifted.
struct Enclosed {
  std::vector<double> volume_mm3, area_mm2;
  std::vector<std::vector<Contact>> contacts;  // in both tissues' lists

  Enclosed(const TissueMesh& mesh, const InterfaceFaces& interfaces, std::size_t tissues)
      : volume_mm3(tissues, 0), area_mm2(tissues, 0), contacts(tissues) {
    for (const InterfaceFace& face : interfaces.faces) {
      const Vec3 out = area_vector(mesh, face);
      const auto& [a, b, c] = face.vertices;
      const double part = dot(mesh.points_mm[a] + mesh.points_mm[b] + mesh.points_mm[c], out) / 9;
      volume_mm3[face.low] += part;
      volume_mm3[face.high] -= part;
      if (face.border) continue;
      add(face.low, face.high, norm(out));
      add(face.high, face.low, norm(out));
    }
  }

  void add(TissueId tissue, TissueId other, double area) {
    auto& list = contacts[tissue];
    const auto known = std::ranges::find(list, other, &Contact::other);
    if (known == list.end()) {
      list.push_back({other, area});
    } else {
      known->area_mm2 += area;
    }
    area_mm2[tissue] += area;
  }
};

}  // namespace

VolumeShifts::VolumeShifts(const TissueImage& image) : image_(image), by_low_(image.labels.size()) {
  for (std::size_t t = 0; t < image.labels.size(); ++t) wanted_mm3_.push_back(image.volume_mm3(t));
}

VolumeShifts::Shift& VolumeShifts::shift_of(TissueId low, TissueId high) {
  auto& list = by_low_[low];
  const auto known = std::ranges::find(list, high, &Shift::high);
  return known != list.end() ? *known : list.emplace_back(Shift{high});
}

// How far each tissue would have to grow, by Gauss-Seidel on the graph of the contacts: where two of them meet, what
// one has more than the other counts.
void VolumeShifts::update(const TissueMesh& mesh, const InterfaceFaces& interfaces) {
  const std::size_t tissues = image_.labels.size();
  const Enclosed now(mesh, interfaces, tissues);
  std::vector<double> growth_mm(tissues, 0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t t = 1; t < tissues; ++t) {
      if (now.area_mm2[t] == 0) continue;
      double sum = wanted_mm3_[t] - now.volume_mm3[t];
      for (const Contact& c : now.contacts[t]) sum += c.area_mm2 * growth_mm[c.other];
      growth_mm[t] = sum / now.area_mm2[t];
    }
  }
  const Vec3 s = image_.spacing_mm;
  const double most = kMostShift * (s.x + s.y + s.z) / 3;
  for (std::size_t low = 0; low < tissues; ++low) {
    for (const Contact& c : now.contacts[low]) {
      if (c.other < low) continue;
      double& shift = shift_of(static_cast<TissueId>(low), c.other).mm;
      shift = std::clamp(shift + kDamping * (growth_mm[low] - growth_mm[c.other]), -most, most);
    }
  }
}

std::vector<double> enclosed_volumes(const TissueMesh& mesh, const InterfaceFaces& interfaces, std::size_t tissues) {
  return Enclosed(mesh, interfaces, tissues).volume_mm3;
}

double VolumeShifts::between(TissueId low, TissueId high) const {
  const auto known = std::ranges::find(by_low_[low], high, &Shift::high);
  return known != by_low_[low].end() ? known->mm : 0;
}

}  // namespace anatomesh
