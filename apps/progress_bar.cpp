#include "apps/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <utility>

#include "apps/messages.h"

namespace anatomesh::apps {
namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kRedrawEvery{100};

double seconds(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

/// "12 s left", or nothing while too little is done to tell.
std::string time_left(double elapsed_s, double fraction) {
  if (elapsed_s < 1 || fraction < 0.03 || fraction >= 1) return "";
  const double left_s = elapsed_s * (1 - fraction) / fraction;
  if (left_s < 90) return fmt::format("{:.0f} s left", left_s);
  return fmt::format("{:.0f} min left", left_s / 60);
}

}  // namespace

ProgressBar::ProgressBar(Verbosity verbosity)
    : verbosity_(verbosity), on_terminal_(isatty(STDERR_FILENO) == 1), begin_(Clock::now()) {}

ProgressBar::~ProgressBar() { erase(); }

Progress ProgressBar::part(double begin, double end, std::stop_token cancel) {
  const auto report = [this, begin, end](std::string_view stage, double fraction) {
    show(stage, begin + (end - begin) * fraction);
  };
  return {report, std::move(cancel)};
}

void ProgressBar::show(std::string_view stage, double fraction) {
  if (verbosity_ == Verbosity::quiet) return;
  if (stage != stage_) start_stage(stage, fraction);
  if (on_terminal_) draw(fraction);
}

void ProgressBar::start_stage(std::string_view stage, double fraction) {
  end_stage();
  stage_ = stage;
  stage_begin_ = Clock::now();
  last_drawn_ = {};
  if (!on_terminal_) put_on_stderr(fmt::format("{:3.0f} %  {}\n", 100 * fraction, stage_));
}

void ProgressBar::end_stage() {
  if (stage_.empty() || verbosity_ != Verbosity::verbose) return;
  erase();
  print_note(fmt::format("{}: {:.2f} s", stage_, seconds(Clock::now() - stage_begin_)));
}

void ProgressBar::draw(double fraction) {
  const Clock::time_point now = Clock::now();
  if (now - last_drawn_ < kRedrawEvery) return;
  last_drawn_ = now;
  const auto filled = static_cast<std::size_t>(fraction * kBarWidth);
  const std::string bar(filled, '#');
  put_on_stderr(fmt::format("\r\033[K[{:.<{}}] {:3.0f} %  {}  {}", bar, kBarWidth, 100 * fraction, stage_,
                            time_left(seconds(now - begin_), fraction)));
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::erase() {
  if (!drawn_) return;
  put_on_stderr("\r\033[K");
  drawn_ = false;
}

void ProgressBar::finish() {
  end_stage();
  stage_.clear();
  erase();
}

}  // namespace anatomesh::apps
