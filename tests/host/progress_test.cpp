// SPDX-License-Identifier: Apache-2.0
// The progress line with the remaining time of a task.
#include "cde/support/progress.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "../has.hpp"

namespace cde {
namespace {

/// The lines that are drawn while this object lives.
class Lines {
 public:
  Lines() {
    set_progress_display([this](std::string_view line) {
      const std::lock_guard lock(mutex_);
      all_.emplace_back(line);
    });
  }
  ~Lines() { set_progress_display({}); }
  [[nodiscard]] std::vector<std::string> all() const {
    const std::lock_guard lock(mutex_);
    return all_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> all_;
};

void wait(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

TEST(Progress, ShareAndStep_TellTheTimeLeft) {
  Lines lines;
  {
    Progress progress("fp");
    progress(0, "add");
    wait(700);
    progress(0.1, "mul");  // no further call, as in a long step
    wait(500);
  }
  ASSERT_EQ(lines.all().size(), 2u);
  EXPECT_EQ(lines.all()[0], "fp, mul  10 %, 1 s, about 6 s left");
  EXPECT_EQ(lines.all()[1], "") << "the line must be cleared";
}

TEST(Progress, UnknownShare_TellsTheTimePassed) {
  Lines lines;
  {
    const Progress progress("loading");
    wait(1200);
  }
  ASSERT_EQ(lines.all().size(), 2u);
  EXPECT_EQ(lines.all()[0], "loading, 1 s");
}

TEST(Progress, UsualTime_IsTheTimeLeftUntilItHasPassed) {
  Lines lines;
  {
    Progress progress("building");
    progress.expect(2, "compiling");
    wait(2500);
  }
  ASSERT_EQ(lines.all().size(), 3u);
  EXPECT_EQ(lines.all()[0], "building, compiling, 1 s, about 1 s left");
  EXPECT_EQ(lines.all()[1], "building, compiling, 2 s");
}

TEST(Progress, TaskWithinATask_IsTheOneShown) {
  Lines lines;
  {
    const Progress outer("outer");
    {
      const Progress inner("inner");
      wait(1200);
    }
    wait(1000);
  }
  for (const std::string& line : lines.all()) EXPECT_FALSE(has(line, "outer, 1 s")) << line;
  ASSERT_EQ(lines.all().size(), 4u);
  EXPECT_EQ(lines.all()[0], "inner, 1 s");
  EXPECT_EQ(lines.all()[2], "outer, 2 s");
}

TEST(Progress, OtherText_ClearsTheLineFirst) {
  Lines lines;
  const Progress progress("loading");
  wait(1200);
  clear_progress();
  clear_progress();
  EXPECT_EQ(lines.all(), (std::vector<std::string>{"loading, 1 s", ""}));
}

TEST(Progress, ShortOrQuietTask_DrawsNothing) {
  Lines lines;
  {
    Progress quiet("quiet", true);
    quiet(0.5);
    wait(1200);
    const Progress brief("short");
  }
  EXPECT_TRUE(lines.all().empty());
}

}  // namespace
}  // namespace cde
