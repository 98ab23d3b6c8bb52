// How much memory there is.
#pragma once

namespace anatomesh {

/// Memory that can be had without swapping, in GiB; 0 where the system does not say.
double available_memory_gib();

}  // namespace anatomesh
