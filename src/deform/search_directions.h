// Directions in which a vertex may look for a better place.
#pragma once

#include <array>

#include "anatomesh/types.h"

namespace anatomesh {

/// Unit vectors to the sides and the corners of a cube.
inline constexpr double kCorner = 0.57735026918962576;
inline constexpr std::array<Vec3, 14> kSearchDirections = {{{1, 0, 0},
                                                            {-1, 0, 0},
                                                            {0, 1, 0},
                                                            {0, -1, 0},
                                                            {0, 0, 1},
                                                            {0, 0, -1},
                                                            {kCorner, kCorner, kCorner},
                                                            {kCorner, kCorner, -kCorner},
                                                            {kCorner, -kCorner, kCorner},
                                                            {kCorner, -kCorner, -kCorner},
                                                            {-kCorner, kCorner, kCorner},
                                                            {-kCorner, kCorner, -kCorner},
                                                            {-kCorner, -kCorner, kCorner},
                                                            {-kCorner, -kCorner, -kCorner}}};

}  // namespace anatomesh
