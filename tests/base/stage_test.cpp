#include "base/stage.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace anatomesh {
namespace {

/// What was reported, and a way to stop.
struct Watch {
  std::vector<std::pair<std::string, double>> reports;
  std::stop_source stop;
  Progress progress{[this](std::string_view stage, double fraction) { reports.emplace_back(stage, fraction); },
                    stop.get_token()};
};

TEST(Stage, ReportsItsShareOfTheWhole) {
  Watch watch;
  const Stage stage(watch.progress, "lattice", 0.2, 0.6);
  stage.at(0.5);
  stage.at(1);
  ASSERT_EQ(watch.reports.size(), 3u);
  EXPECT_EQ(watch.reports[0].first, "lattice");
  EXPECT_DOUBLE_EQ(watch.reports[0].second, 0.2);
  EXPECT_DOUBLE_EQ(watch.reports[1].second, 0.4);
  EXPECT_DOUBLE_EQ(watch.reports[2].second, 0.6);
}

TEST(Stage, PartsLieInside) {
  Watch watch;
  const Stage stage(watch.progress, "deform", 0.5, 1);
  const Stage part = stage.part("register", 0.2, 0.6);
  part.at(1);
  EXPECT_EQ(watch.reports.back().first, "register");
  EXPECT_NEAR(watch.reports[1].second, 0.6, 1e-12);
  EXPECT_NEAR(watch.reports[2].second, 0.8, 1e-12);
}

TEST(Stage, ProgressOfStagesInOrderNeverFalls) {
  Watch watch;
  for (int s = 0; s < 4; ++s) {
    const Stage stage(watch.progress, "stage", s / 4.0, (s + 1) / 4.0);
    for (int n = 0; n <= 10; ++n) stage.at(n / 10.0);
  }
  double last = 0;
  for (const auto& [name, fraction] : watch.reports) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
  }
  EXPECT_DOUBLE_EQ(last, 1);
}

TEST(Stage, ThrowsOnceAskedToStop) {
  Watch watch;
  const Stage stage(watch.progress, "lattice", 0, 1);
  EXPECT_NO_THROW(stage.check_cancelled());
  watch.stop.request_stop();
  EXPECT_THROW(stage.check_cancelled(), Cancelled);
  EXPECT_THROW(stage.at(0.5), Cancelled);
  EXPECT_THROW(stage.part("part", 0, 1), Cancelled);
  EXPECT_TRUE(stage.cancel_token().stop_requested());
  EXPECT_EQ(watch.reports.size(), 1u) << "no report after the stop";
}

TEST(Stage, NobodyNeedsToWatch) {
  const Progress nobody;
  const Stage stage(nobody, "lattice", 0, 1);
  EXPECT_NO_THROW(stage.at(0.5));
  EXPECT_NO_THROW(stage.check_cancelled());
}

}  // namespace
}  // namespace anatomesh
