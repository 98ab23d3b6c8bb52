// Shows how far the work is, on the error stream.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <string_view>

#include "anatomesh/progress.h"

namespace anatomesh::apps {

enum class Verbosity { quiet, normal, verbose };

/// A bar with stage, percentage and time left on a terminal; one plain line a stage elsewhere; nothing when quiet.
/// When verbose, also the time each stage took.
class ProgressBar {
 public:
  explicit ProgressBar(Verbosity verbosity);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For a long call that is the part from `begin` to `end` (0 to 1) of the whole work.
  Progress part(double begin, double end, std::stop_token cancel);

  void show(std::string_view stage, double fraction);

  /// Ends the last stage and takes the bar away.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void start_stage(std::string_view stage, double fraction);
  void end_stage();
  void draw(double fraction);
  void erase();

  Verbosity verbosity_;
  bool on_terminal_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point begin_, stage_begin_, last_drawn_;
};

}  // namespace anatomesh::apps
