// SPDX-License-Identifier: Apache-2.0
// The package of a failure: a folder with waves around it, and the line where card and reference
// differ.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../has.hpp"
#include "planted.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Bundles : public Cli {
 protected:
  Ran shell_in(const Planted& fault, const std::string& script) {
    std::string exports;
    for (const std::string& variable : fault.environment()) exports += "export " + variable + "\n";
    return shell(exports + script);
  }
  json bundle(const std::string& folder = "cde-failure") {
    for (const char* name : {"fail.txt", "fail.json", "waves.fst", "waves.gtkw"})
      EXPECT_TRUE(exists(folder + "/" + name)) << name;
    EXPECT_FALSE(exists(folder + "/whole.fst"));
    const json j = json::parse(read(folder + "/fail.json"));
    for (const std::string& key : keys_of(j.dump()))
      EXPECT_TRUE(documented_keys().contains(key))
          << "docs/reference/json.md lacks the key " << key;
    return j;
  }
};

const char* const kPair = "0.6 0.3 5 0 0 -1 | 0.5 0.1 0 1.5 0 0 0.5 1 0\n";

TEST_F(Bundles, WrongPair_IsPacked) {
  const Planted fault(folder_, "rtl/pipes/ray_triangle_moller.sv", "`DF_DOT(u, p, s)",
                      "`DF_DOT(u, p, e1)");
  std::string pairs;
  for (int i = 0; i < 20; ++i) pairs += kPair;
  write("pairs", pairs);
  const std::string query = "< pairs \"$CDE\" query ray-triangle -q";
  const Ran ran = shell_in(fault, query);
  EXPECT_EQ(ran.status, 3) << ran.err;
  EXPECT_TRUE(has(ran.err, "packed in:   cde-failure\n"));
  const json j = bundle();
  EXPECT_EQ(j["failure"], "mismatch");
  EXPECT_EQ(j["pair"], "ray-triangle");
  EXPECT_EQ(j["happened_again"], true);
  EXPECT_EQ(j["differs_alone"], true);
  const json& place = j["first_differences"][0]["sources"][0][0];
  EXPECT_EQ(place["file"], "ray_triangle_moller.sv");
  EXPECT_EQ(place["line"], fault.line());
  EXPECT_FALSE(j["near_lines"].empty());
  EXPECT_TRUE(has(read("cde-failure/fail.txt"), "ray_triangle_moller.sv:"));
  // At the failing time in the waves the signal holds the wrong answer, and the command in the
  // package runs.
  const std::string signal = j["wrong_signal"];
  const Ran at =
      cde({"wave", "at", "cde-failure/waves.fst", "fail", signal, "pair_unit.valid_o", "--json"},
          fault.environment());
  ASSERT_EQ(at.status, 0) << at.err;
  const json values = json::parse(at.out)["values"];
  EXPECT_EQ(values[0]["value"], j["card_answer"]["F"] == true ? "true" : "0");
  EXPECT_EQ(values[1]["value"], "1");
  // An existing folder stays.
  EXPECT_EQ(shell_in(fault, query + " --bundle cde-failure").status, 3);
  EXPECT_TRUE(exists("cde-failure-2/fail.txt"));
  EXPECT_EQ(shell_in(fault, query + " --no-bundle").status, 3);
  EXPECT_FALSE(exists("cde-failure-3"));
  write("file", "");
  const Ran nowhere = shell_in(fault, query + " --bundle file/there");
  EXPECT_EQ(nowhere.status, 3);
  EXPECT_TRUE(has(nowhere.err, "not packed:  file/there"));
}

const char* const kTwice =
    "v 0 0 1\nv 2 0 1\nv 0 2 1\nf 1 2 3\nf 1 2 3\nv 0 0 0\nv 2 0 0\nv 0 2 0\nf 4 5 6\n";

TEST_F(Bundles, WrongRecord_IsPacked) {
  const Planted fault(folder_, "rtl/update/update_lanes.sv", "{CW{index_i < index_old[l]}}",
                      "{CW{index_i > index_old[l]}}");
  write("twice.obj", kTwice);
  const Ran ran = cde({"cast", "twice.obj", "--ray", "0.5,0.5,5,0,0,-1", "-q", "--exact-card"},
                      fault.environment());
  EXPECT_EQ(ran.status, 3) << ran.err;
  const json j = bundle();
  EXPECT_EQ(j["happened_again"], true);
  EXPECT_EQ(j["differs_alone"], false);
  EXPECT_EQ(j["stage"], "in the choice of the better answer");
  EXPECT_TRUE(j["wrong_signal"].get<std::string>().ends_with("update.better[0]"));
  EXPECT_EQ(j["cause_lines"][0]["file"], "update_lanes.sv");
  const std::string page = read("cde-failure/fail.txt");
  EXPECT_TRUE(has(page, "the pipe says that primary 0 and secondary 1 meet, as the reference"));
}

TEST_F(Bundles, HangingCard_IsPacked) {
  const Planted fault(folder_, "rtl/engine/engine_control.sv",
                      "assign done_o = state_q == WRITEBACK && !write_q",
                      "assign done_o = state_q == WRITEBACK && pending_q == 3");
  write("twice.obj", kTwice);
  const Ran ran = cde({"cast", "twice.obj", "--ray", "0.5,0.5,5,0,0,-1", "-q", "--exact-card"},
                      fault.environment());
  EXPECT_EQ(ran.status, 4) << ran.err;
  EXPECT_TRUE(has(ran.err, "packed in:   cde-failure\n"));
  EXPECT_EQ(bundle()["failure"], "timeout");
  const std::string page = read("cde-failure/fail.txt");
  EXPECT_TRUE(has(page, "Unfinished transactions:"));
  EXPECT_TRUE(has(page, "record of primary 0"));
}

/// A pipe that never returns its last row, and a pipe that answers a later row first.
TEST_F(Bundles, HangingPipe_IsPacked) {
  write("rows", "0,0,0,1,0,0,0,1\n0,0,0,1,1.5,0,0,1\nno pair\n0,0,0,1,5,0,0,1\n");
  const std::string query = "\"$CDE\" query sphere-sphere --lanes 1 -q ";
  const Planted fault(folder_, "rtl/engine/issue_history.sv", "valid_mem[read_q];",
                      "valid_mem[read_q] && q_o != W'(2);");
  const Ran ran = shell_in(fault, query + "< rows");
  EXPECT_EQ(ran.status, 4) << ran.err;
  EXPECT_EQ(ran.out, "") << "no answer was compared, so neither answers nor header are written";
  EXPECT_TRUE(has(ran.err,
                  "lines 1 to 4: pair_unit: 3 of 3 rows of 1 pairs were taken and 2 answered, the "
                  "last at cycle 12; there was no progress for 1000000 cycles"));
  EXPECT_TRUE(has(ran.err, "packed in:   cde-failure\n"));
  const json j = bundle();
  EXPECT_EQ(j["failure"], "timeout");
  EXPECT_EQ(shell_in(fault, "cd cde-failure && " + query + "--no-bundle < pairs.txt").status, 4);
  const Ran at = cde({"wave", "at", "cde-failure/waves.fst", "fail", "pair_unit.tag_o", "--json"},
                     fault.environment());
  EXPECT_EQ(json::parse(at.out)["values"][0]["value"], "00000001") << "the last answered row";

  const Planted other(folder_, "rtl/pair_unit.sv", ".d_i(tag)", ".d_i(tag ^ 32'd1)");
  const Ran exchanged = shell_in(other, query + "--no-bundle < rows");
  EXPECT_EQ(exchanged.status, 4) << exchanged.err;
  EXPECT_TRUE(
      has(exchanged.err, "and 0 answered, the last at cycle 2; then an answer came for another"));
}

/// A deadline that the user set is not a failure of the card.
TEST_F(Bundles, Deadline_IsNotPacked) {
  write("twice.obj", kTwice);
  EXPECT_EQ(
      cde({"cast", "twice.obj", "--ray", "0.5,0.5,5,0,0,-1", "-q", "--deadline", "10"}).status, 4);
  EXPECT_FALSE(exists("cde-failure"));
}

}  // namespace
}  // namespace cde::testing
