// SPDX-License-Identifier: Apache-2.0
// The tutorial as it is written: its commands in one shell, their output, and the line that they
// find.
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "run_cde.hpp"

namespace cde::testing {
namespace {

struct Step {
  std::string command, shown;  ///< with the lines below it; `...` stands for any further lines
};

std::vector<Step> steps_of(const std::string& document) {
  std::ifstream in(document);
  std::vector<Step> steps;
  std::string blank;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("    $ ")) {
      steps.push_back({line.substr(6), ""});
      inside = true;
    } else if (inside && line.starts_with("    ")) {
      steps.back().shown += blank + line.substr(4) + "\n";
    } else if (!line.empty()) {
      inside = false;
    }
    blank = line.empty() ? blank + "\n" : "";
  }
  return steps;
}

class Tutorial : public Cli {};

TEST_F(Tutorial, Tutorial_LeadsToTheWrongLine) {
  const std::vector<Step> steps = steps_of(CDE_SOURCE_DIR "/docs/start/tutorial.md");
  ASSERT_GE(steps.size(), 8u);
  // A separator line that no command prints.
  const std::string mark = "\x01\n";
  std::string script =
      "source='" CDE_SOURCE_DIR "'\ncde() { \"$CDE\" \"$@\"; }\nCOLUMNS=100\nexec 2>&1\n";
  for (const Step& step : steps) script += step.command + "\nprintf '\\001\\n'\n";
  std::string out = shell(script).out;
  for (const Step& step : steps) {
    SCOPED_TRACE(step.command);
    const std::size_t end = out.find(mark);
    ASSERT_NE(end, std::string::npos) << out;
    std::string got = out.substr(0, end), shown = step.shown;
    out.erase(0, end + mark.size());
    // The tutorial does not show how long a card takes to build.
    static const std::regex building(
        "cde: (building|built in|reading the structure|[0-9]+ s,) [^\n]*\n");
    got = std::regex_replace(got, building, "");
    while (got.ends_with("\n\n")) got.pop_back();
    if (shown.ends_with("...\n")) {
      shown.erase(shown.size() - 4);
      got.resize(std::min(got.size(), shown.size()));
    }
    EXPECT_EQ(got, shown);
  }
}

}  // namespace
}  // namespace cde::testing
