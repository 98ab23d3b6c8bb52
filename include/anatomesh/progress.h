// Progress and cancellation of a long call.
#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace anatomesh {

/// Handed to a long call. Both members may be left empty.
struct Progress {
  /// Called on the caller's thread with the name of the present stage and the share of the whole
  /// work that is done, 0 to 1 and never falling. Must not throw.
  std::function<void(std::string_view stage, double fraction)> report;

  /// Once stop is requested the call ends with Cancelled, within about a tenth of a second for images
  /// of ordinary size, and leaves nothing behind.
  std::stop_token cancel;
};

}  // namespace anatomesh
