#include "io/nifti_bytes.h"

#include <algorithm>

namespace anatomesh::testing {

std::string NiftiBytes::header(bool swapped) const {
  std::string bytes(348, '\0');
  const auto set = [&](std::size_t at, auto number) {
    std::array<char, sizeof(number)> raw;
    std::memcpy(raw.data(), &number, raw.size());
    if (swapped) std::reverse(raw.begin(), raw.end());
    std::copy(raw.begin(), raw.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const auto set_all = [&](std::size_t at, const auto& numbers) {
    for (std::size_t n = 0; n < numbers.size(); ++n) set(at + n * sizeof(numbers[n]), numbers[n]);
  };
  set(0, std::int32_t{348});
  set_all(40, dim);
  set(68, intent_code);
  set(70, datatype);
  set(72, bitpix);
  set_all(76, pixdim);
  set(108, 352.0F);  // where the voxels start
  set(112, scl_slope);
  set(116, scl_inter);
  bytes[123] = xyzt_units;
  set(252, qform_code);
  set(254, sform_code);
  set_all(256, quatern);
  set_all(268, qoffset);
  for (std::size_t row = 0; row < 3; ++row) set_all(280 + 16 * row, srow[row]);
  std::copy(magic.begin(), magic.end(), bytes.begin() + 344);
  return bytes;
}

}  // namespace anatomesh::testing
