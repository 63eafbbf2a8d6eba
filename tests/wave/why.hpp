// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "../has.hpp"
#include "run_cde.hpp"
#include "sample.hpp"

/// Tests of cde wave why with designs whose structure Verilator writes during the test.
namespace cde::testing {

class Why : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_sample(folder_ / "a.fst");
  }
  /// Writes Verilator's XML of a design in one file.
  void structure(const std::string& name, const std::string& source) {
    write(name + ".sv", source);
    const Ran ran = shell("verilator -O0 --xml-only -Wno-fatal --xml-output " + name + ".xml " +
                          "--top-module " + name + " " + name + ".sv");
    ASSERT_EQ(ran.status, 0) << ran.err;
  }
  /// The file of that name in the tested form.
  [[nodiscard]] virtual std::string file(const std::string& xml) const { return xml; }
  nlohmann::json why(const std::string& waves, const std::string& what, const std::string& xml,
                     const std::vector<std::string>& options = {}) {
    std::vector<std::string> words = {"wave", "why", waves, what, "--json"};
    if (!xml.empty()) words.insert(words.end(), {"--structure", file(xml)});
    words.insert(words.end(), options.begin(), options.end());
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return ran.status == 0 ? nlohmann::json::parse(ran.out) : nlohmann::json();
  }
  std::string error(const std::string& waves, const std::string& what, const std::string& xml) {
    std::vector<std::string> words = {"wave", "why", waves, what};
    if (!xml.empty()) words.insert(words.end(), {"--structure", xml});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2) << ran.out << ran.err;
    EXPECT_EQ(ran.out, "");
    EXPECT_FALSE(has(ran.err, "crashed"));
    return ran.err;
  }
  /// The causes of a statement as "name=value@time:line".
  static std::vector<std::string> causes(const nlohmann::json& statement) {
    std::vector<std::string> all;
    for (const nlohmann::json& c : statement["causes"]) {
      std::string text = fmt::format(
          "{}{}={}@{}", c["condition"] == true ? "if " : "", c["name"].get<std::string>(),
          c["bits"].is_null() ? "?" : c["bits"].get<std::string>(), c["time"].dump());
      if (!c["statements"].empty()) text += fmt::format(":{}", c["statements"][0]["line"].dump());
      all.push_back(std::move(text));
    }
    return all;
  }
  using Texts = std::vector<std::string>;
};

/// A structure in both forms: from the installed Verilator, and from a Verilator without --xml-only
/// (structures/make).
class WhyStructure : public Why, public ::testing::WithParamInterface<const char*> {
 protected:
  [[nodiscard]] std::string file(const std::string& xml) const override {
    return xml.substr(0, xml.rfind(".xml")) + GetParam();
  }
  /// The structure of NAME.sv, which lies beside this file.
  void structure(const std::string& name) {
    const std::filesystem::path folder = std::filesystem::path(CDE_SOURCE_DIR) / "tests/wave";
    std::stringstream source;
    source << std::ifstream(folder / (name + ".sv")).rdbuf();
    Why::structure(name, source.str());
    for (const char* part : {".tree.json", ".tree.meta.json"})
      std::filesystem::copy_file(folder / "structures" / (name + part), folder_ / (name + part));
  }
};
}  // namespace cde::testing
