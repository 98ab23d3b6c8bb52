// What libhdf5 1.10 does not check before it computes with it.
#pragma once

#include <cstdint>
#include <filesystem>

namespace anatomesh {

/// Whether the header of a dataset, at this place in the file, has chunks of size 0, by which the library divides.
bool has_empty_chunks(const std::filesystem::path& file, std::uint64_t header_address);

}  // namespace anatomesh
