// Matrices whose columns should be orthogonal unit vectors.
#pragma once

#include "anatomesh/types.h"

namespace anatomesh {

/// How far the direction matrix of an image may be from orthonormal: files keep few digits, but a sheared image cannot
/// be represented.
inline constexpr double kDirectionTolerance = 1e-4;

/// Largest deviation of the products of a matrix's columns from those of orthogonal unit vectors; NaN if any entry is.
double deviation_from_orthonormal(const Mat3& matrix);

/// The nearest rotation, with or without a reflection, to a matrix that is one up to about 1e-3. Of
/// its own results it changes no bit.
Mat3 nearest_orthonormal(Mat3 matrix);

}  // namespace anatomesh
