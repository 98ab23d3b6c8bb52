#include "benchmarks/stages/bricks.h"

#include <algorithm>
#include <cmath>

namespace anatomesh::benchmarks {

LabelImage wavy_bricks(std::size_t side, std::size_t labels) {
  constexpr double kBall = 0.46, kWave = 0.03, kWaves = 9;
  LabelImage image;
  image.size = {side, side, side};
  image.voxels.assign(side * side * side, 0);
  const auto rows = static_cast<std::size_t>(std::max(1.0, std::floor(std::cbrt(static_cast<double>(labels)))));
  const std::size_t columns = std::max<std::size_t>(1, labels / (rows * rows));
  const auto brick = [&](double at, std::size_t count) {
    const auto n = static_cast<std::ptrdiff_t>(std::floor((at / kBall + 1) / 2 * static_cast<double>(count)));
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(n, 0, static_cast<std::ptrdiff_t>(count) - 1));
  };
  const auto centred = [&](std::size_t index) {
    return (static_cast<double>(index) + 0.5) / static_cast<double>(side) - 0.5;
  };
  std::size_t voxel = 0;
  for (std::size_t k = 0; k < side; ++k) {
    for (std::size_t j = 0; j < side; ++j) {
      for (std::size_t i = 0; i < side; ++i, ++voxel) {
        const double x = centred(i), y = centred(j), z = centred(k);
        if (x * x + y * y + z * z > kBall * kBall) continue;
        const std::size_t a = brick(x + kWave * std::sin(kWaves * y), columns);
        const std::size_t b = brick(y + kWave * std::sin(kWaves * z), rows);
        const std::size_t c = brick(z + kWave * std::sin(kWaves * x), rows);
        image.voxels[voxel] = static_cast<Label>(1 + a + columns * (b + rows * c));
      }
    }
  }
  return image;
}

LabelImage small_ball(std::size_t side, double radius) {
  LabelImage image;
  image.size = {side, side, side};
  image.voxels.assign(side * side * side, 0);
  const double middle = 0.5 * static_cast<double>(side - 1);
  std::size_t voxel = 0;
  for (std::size_t k = 0; k < side; ++k) {
    for (std::size_t j = 0; j < side; ++j) {
      for (std::size_t i = 0; i < side; ++i, ++voxel) {
        const auto off = [&](std::size_t index) { return static_cast<double>(index) - middle; };
        image.voxels[voxel] = std::hypot(off(i), off(j), off(k)) <= radius ? 1 : 0;
      }
    }
  }
  return image;
}

}  // namespace anatomesh::benchmarks
