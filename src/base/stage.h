// A stage's share of the progress, and where it asks whether to stop.
#pragma once

#include <cmath>
#include <string_view>

#include "anatomesh/errors.h"
#include "anatomesh/progress.h"

namespace anatomesh {

/// Maps the progress of one stage (0 to 1) to its share of the whole work. Use from the calling thread only;
/// check_cancelled() from any.
class Stage {
 public:
  Stage(const Progress& progress, std::string_view name, double begin, double end)
      : progress_(progress), name_(name), begin_(begin), end_(end) {
    at(0);
  }

  /// Reports that this share of the stage is done. Throws Cancelled.
  void at(double share) const {
    check_cancelled();
    if (progress_.report) progress_.report(name_, std::lerp(begin_, end_, share));
  }

  /// Throws Cancelled when the caller asked to stop.
  void check_cancelled() const {
    if (progress_.cancel.stop_requested()) throw Cancelled();
  }

  /// A stage of its own inside this one.
  Stage part(std::string_view name, double begin, double end) const {
    return {progress_, name, std::lerp(begin_, end_, begin), std::lerp(begin_, end_, end)};
  }

  std::stop_token cancel_token() const { return progress_.cancel; }

 private:
  const Progress& progress_;
  std::string_view name_;
  double begin_, end_;
};

}  // namespace anatomesh
