// SPDX-License-Identifier: Apache-2.0
// Packs a failing test of cards into build/failures/TEST, or $CDE_FAILURES/TEST. The listener runs
// the test again, alone, and records waves of every board that it opens. It is active in every
// executable that links this file.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "cde/support/error.hpp"
#include "cde/wave/export.hpp"
#include "pair_failure.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

constexpr long kLongMs = 20'000;  ///< a longer test makes waves that are too large to look at
/// Limit in seconds, including the build of a card with waves.
constexpr const char* kWavesTake = "600";

/// Writes a description of the waves of boards, so that GTKWave shows every signal.
std::size_t describe_waves(const fs::path& folder) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".fst") continue;
    ++files;
    fs::path save = entry.path();
    save.replace_extension(".gtkw");
    try {
      wave::Trace trace(entry.path());
      wave::write_gtkw(trace, {}, {}, save);
    } catch (const cde::Error&) {  // the waves themselves stay
    }
  }
  return files;
}

class Packs : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override { said_.clear(); }
  void OnTestPartResult(const ::testing::TestPartResult& part) override {
    if (!part.failed()) return;
    said_ += std::string(part.file_name() != nullptr ? part.file_name() : "?") + ":" +
             std::to_string(part.line_number()) + ": " + part.message() + "\n";
  }
  void OnTestEnd(const ::testing::TestInfo& test) override {
    if (!test.result()->Failed() || std::getenv("CDE_WAVES") != nullptr) return;
    std::printf("%s\n", pack(test).c_str());
  }

  std::string pack(const ::testing::TestInfo& test) const {
    if (test.result()->elapsed_time() > kLongMs)
      return "not packed: the test takes " + std::to_string(test.result()->elapsed_time() / 1000) +
             " s; CDE_WAVES=FOLDER runs it with waves";
    std::error_code error;
    const std::string name = std::string(test.test_suite_name()) + "." + test.name();
    const fs::path folder = failures_folder() / test_name();
    fs::remove_all(folder, error);
    fs::create_directories(folder, error);
    if (error) return "not packed: " + folder.string() + ": " + error.message();
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    const std::string again = quoted(self.string()) + " --gtest_filter=" + quoted(name);
    const Ran ran = run_shell("CDE_WAVES=" + quoted(folder.string()) + " timeout " + kWavesTake +
                              " " + again + " 2>&1");
    const std::size_t files = describe_waves(folder);
    std::ofstream text(folder / "fail.txt");
    text << name << " failed\n\n"
         << said_ << "\nto repeat it with waves of all boards:\n  CDE_WAVES=FOLDER " << again
         << "\n\noutput of the repeated test (exit status " << ran.status << "):\n"
         << ran.said;
    text.close();
    if (ran.status == 0)
      return "packed in: " + folder.string() + ", but the repeated test with waves passes";
    return "packed in: " + folder.string() + ", waves of " + std::to_string(files) +
           (files == 1 ? " board" : " boards");
  }

  std::string said_;
};

// GoogleTest owns the listener.
[[maybe_unused]] const bool kListens = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new Packs);
  return true;
}();

}  // namespace
}  // namespace cde::testing
