#include "support/test_images.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "anatomesh/types.h"

namespace anatomesh::testing {
namespace {

double distance(Vec3 a, Vec3 b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

Vec3 voxel(int i, int j, int k) { return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}; }

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = {b.x - a.x, b.y - a.y, b.z - a.z};
  const double along =
      ((p.x - a.x) * d.x + (p.y - a.y) * d.y + (p.z - a.z) * d.z) / (d.x * d.x + d.y * d.y + d.z * d.z);
  const double t = std::clamp(along, 0.0, 1.0);
  return distance(p, {a.x + t * d.x, a.y + t * d.y, a.z + t * d.z});
}

/// SplitMix64 (Steele, Lea, Flood 2014): std's distributions differ between platforms.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t below(std::uint64_t n) { return next() % n; }

 private:
  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30u)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27u)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31u);
  }

  std::uint64_t state_;
};

}  // namespace

LabelImage make_image(std::array<std::size_t, 3> size, const std::function<Label(int, int, int)>& label_at) {
  LabelImage image;
  image.size = size;
  image.voxels.reserve(size[0] * size[1] * size[2]);
  for (std::size_t k = 0; k < size[2]; ++k)
    for (std::size_t j = 0; j < size[1]; ++j)
      for (std::size_t i = 0; i < size[0]; ++i)
        image.voxels.push_back(label_at(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)));
  return image;
}

LabelImage sphere(int radius_vox) {
  const double centre = radius_vox + 2;
  const auto size = static_cast<std::size_t>(2 * radius_vox + 5);
  return make_image({size, size, size}, [=](int i, int j, int k) {
    return Label{distance(voxel(i, j, k), {centre, centre, centre}) <= radius_vox};
  });
}

LabelImage nested_spheres() {
  return make_image({29, 29, 29}, [](int i, int j, int k) {
    const double r = distance(voxel(i, j, k), {14, 14, 14});
    return r <= 4 ? std::numeric_limits<Label>::max() : r <= 8 ? Label{70000} : r <= 12 ? Label{3} : Label{0};
  });
}

LabelImage two_touching_cubes() {
  return make_image({26, 16, 16}, [](int i, int j, int k) {
    const bool inside = i >= 3 && i < 23 && j >= 3 && j < 13 && k >= 3 && k < 13;
    return !inside ? Label{0} : i < 13 ? Label{1} : Label{2};
  });
}

LabelImage three_label_junction() {
  return make_image({25, 25, 25}, [](int i, int j, int k) {
    if (distance(voxel(i, j, k), {12, 12, 12}) > 10) return Label{0};
    const double turn = std::atan2(j - 12.3, i - 11.8) / (2 * 3.14159265358979323846) + 0.5;  // 0 to 1
    return turn < 1.0 / 3 ? Label{1} : turn < 2.0 / 3 ? Label{2} : Label{300};
  });
}

LabelImage four_label_point() {
  constexpr std::array<Vec3, 4> corners = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  return make_image({25, 25, 25}, [&](int i, int j, int k) {
    const Vec3 p = {i - 12.2, j - 11.9, k - 12.1};
    if (distance(p, {}) > 10) return Label{0};
    const auto nearest = std::min_element(corners.begin(), corners.end(),
                                          [&](Vec3 a, Vec3 b) { return distance(p, a) < distance(p, b); });
    return static_cast<Label>(1 + (nearest - corners.begin()));
  });
}

LabelImage one_voxel_sheet() {
  return make_image({22, 22, 9},
                    [](int i, int j, int k) { return Label{k == 4 && i >= 2 && i < 20 && j >= 2 && j < 20}; });
}

LabelImage vessel_tree() {
  constexpr std::array<std::pair<Vec3, Vec3>, 5> tubes = {{{{15, 15, 4}, {15, 15, 13}},
                                                           {{15, 15, 13}, {8, 12, 20}},
                                                           {{15, 15, 13}, {22, 18, 20}},
                                                           {{8, 12, 20}, {6, 18, 26}},
                                                           {{22, 18, 20}, {24, 11, 26}}}};
  return make_image({31, 31, 31}, [&](int i, int j, int k) {
    const Vec3 p = voxel(i, j, k);
    const bool vessel = std::any_of(tubes.begin(), tubes.end(), [&](const auto& tube) {
      return distance_to_segment(p, tube.first, tube.second) <= 1.5;
    });
    const bool tissue = std::hypot((p.x - 15) / 13, (p.y - 15) / 11, (p.z - 15) / 13) <= 1;
    return vessel ? Label{2} : Label{tissue};
  });
}

LabelImage labels_at_border() {
  return make_image({20, 20, 20}, [](int i, int j, int k) {
    if (distance(voxel(i, j, k), {0, 0, 0}) <= 9) return Label{1};
    if (distance(voxel(i, j, k), {19, 19, 10}) <= 8) return Label{2};
    return Label{k == 19 && i < 12 && j < 12} * 3;
  });
}

LabelImage no_background_box() {
  return make_image({18, 16, 14}, [](int i, int j, int k) {
    const bool core = distance(voxel(i, j, k), {9, 8, 7}) <= 5;
    return core ? Label{4} : static_cast<Label>(1 + (i > 8) + (j > 9 && k > 6));
  });
}

LabelImage one_voxel() {
  return make_image({7, 7, 7}, [](int i, int j, int k) { return Label{i == 3 && j == 3 && k == 3}; });
}

LabelImage only_one_voxel() {
  return make_image({1, 1, 1}, [](int, int, int) { return Label{9}; });
}

LabelImage torus() {
  return make_image({29, 29, 13}, [](int i, int j, int k) {
    const double ring = std::hypot(i - 14.0, j - 14.0) - 9;
    return Label{std::hypot(ring, k - 6.0) <= 3.6};
  });
}

LabelImage hollow_sphere() {
  return make_image({25, 25, 25}, [](int i, int j, int k) {
    const double r = distance(voxel(i, j, k), {12, 12, 12});
    return Label{r <= 10 && r > 4};
  });
}

LabelImage checkerboard(int block_vox) {
  const auto size = static_cast<std::size_t>(4 * block_vox);
  return make_image({size, size, size}, [=](int i, int j, int k) {
    return static_cast<Label>((i / block_vox + j / block_vox + k / block_vox) % 3);
  });
}

LabelImage noise(std::uint64_t seed, int size_vox, int labels) {
  Random random(seed);
  const auto size = static_cast<std::size_t>(size_vox);
  return make_image({size, size, size}, [&](int, int, int) {
    return static_cast<Label>(random.below(static_cast<std::uint64_t>(labels) + 1));
  });
}

LabelImage random_blobs(std::uint64_t seed, int size_vox, int blobs) {
  struct Blob {
    Vec3 centre;
    Label label;
  };
  Random random(seed);
  std::vector<Blob> all(static_cast<std::size_t>(blobs));
  const auto coordinate = [&] { return static_cast<double>(random.below(static_cast<std::uint64_t>(size_vox))); };
  for (Blob& blob : all) {
    blob.centre.x = coordinate();
    blob.centre.y = coordinate();
    blob.centre.z = coordinate();
    blob.label = static_cast<Label>(random.below(5));
  }
  const auto size = static_cast<std::size_t>(size_vox);
  return make_image({size, size, size}, [&](int i, int j, int k) {
    const Vec3 p = voxel(i, j, k);
    const auto nearest = std::min_element(all.begin(), all.end(), [&](const Blob& a, const Blob& b) {
      return distance(p, a.centre) < distance(p, b.centre);
    });
    return nearest->label;
  });
}

LabelImage anisotropic(LabelImage image) {
  image.spacing_mm = {0.7, 1.1, 2.5};
  return image;
}

LabelImage oblique(LabelImage image) {
  // Rotation by 0.6 rad about (2, -1, 2) / 3 (Rodrigues).
  const double c = std::cos(0.6), s = std::sin(0.6);
  const std::array<double, 3> axis = {2.0 / 3, -1.0 / 3, 2.0 / 3};
  const Mat3 cross = {{{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}}};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      image.direction[row][column] =
          c * (row == column ? 1 : 0) + s * cross[row][column] + (1 - c) * axis[row] * axis[column];
  image.origin_mm = {-91.5, 126.25, 1072.125};
  return image;
}

LabelImage left_handed(LabelImage image) {
  image.direction = {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  image.origin_mm = {40, -12.5, 7};
  return image;
}

std::vector<NamedImage> all_shapes() {
  return {{"sphere", sphere()},
          {"nested_spheres", nested_spheres()},
          {"two_touching_cubes", two_touching_cubes()},
          {"three_label_junction", three_label_junction()},
          {"four_label_point", four_label_point()},
          {"one_voxel_sheet", one_voxel_sheet()},
          {"vessel_tree", vessel_tree()},
          {"labels_at_border", labels_at_border()},
          {"no_background_box", no_background_box()},
          {"one_voxel", one_voxel()},
          {"only_one_voxel", only_one_voxel()},
          {"torus", torus()},
          {"hollow_sphere", hollow_sphere()},
          {"checkerboard", checkerboard()},
          {"noise", noise(1)},
          {"random_blobs", random_blobs(7)}};
}

std::vector<NamedImage> all_test_images() {
  using Change = LabelImage (*)(LabelImage);
  constexpr std::array<std::pair<const char*, Change>, 3> changes = {
      {{"anisotropic", anisotropic}, {"oblique", oblique}, {"left_handed", left_handed}}};
  std::vector<NamedImage> images = all_shapes();
  const std::vector<NamedImage> shapes = images;
  for (const auto& [name, change] : changes)
    for (const NamedImage& shape : shapes) images.push_back({shape.name + "_" + name, change(shape.image)});
  return images;
}

}  // namespace anatomesh::testing
