// SPDX-License-Identifier: Apache-2.0
// cde bench gpu as a user runs it: figures, keys, devices and messages.
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baselines/baseline_opencl.hpp"
#include "cde/support/error.hpp"
#include "has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

using nlohmann::json;

/// Runs of the command on the first OpenCL device.
class BenchGpu : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    try {
      (void)baseline::opencl_devices();
    } catch (const Error& e) {
      GTEST_SKIP() << e.what();
    }
  }
  /// The figures of `cde bench gpu` with these words.
  [[nodiscard]] json figures(std::vector<std::string> words) {
    words.insert(words.begin(), {"bench", "gpu", "--json"});
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 0) << ran.err;
    err_ = ran.err;
    const json j = json::parse(ran.out, nullptr, false);
    return j.is_discarded() ? json() : j["gpu"];
  }
  std::string err_;
};

void expect_cast(const json& cast, bool exact) {
  EXPECT_GT(cast["kernel_seconds"], 0);
  EXPECT_GT(cast["seconds_with_copies"], cast["kernel_seconds"]);
  EXPECT_GE(cast["seconds_with_upload"], cast["seconds_with_copies"]);
  for (const char* key : {"spread_kernel", "spread_copies", "spread_upload"}) {
    EXPECT_GE(cast[key]["measurements"], 9) << key;
    EXPECT_LE(cast[key]["least"], cast[key]["median"]) << key;
    EXPECT_LE(cast[key]["median"], cast[key]["most"]) << key;
  }
  EXPECT_EQ(cast["spread_kernel"]["median"], cast["kernel_seconds"]);
  EXPECT_GE(cast["records_compared"], 10 * cast["rays"].get<int>());
  std::size_t differing = 0;
  for (const char* key : {"extra_hits", "missed_hits", "other_t", "other_triangles", "rounded_t"})
    differing += cast[key].get<std::size_t>();
  EXPECT_EQ(cast["records_matching"].get<std::size_t>() + differing, cast["records_compared"]);
  if (exact) {
    EXPECT_EQ(differing, 0u);
  }
}

TEST_F(BenchGpu, QuickRun_ReportsPlausibleFigures) {
  const json j = figures({"--quick"});
  ASSERT_TRUE(j.is_object());
  EXPECT_EQ(j["triangles"], 12'800);
  EXPECT_GT(j["nodes"], 12'800 / 4);
  EXPECT_GT(j["build_seconds"], 0);
  const json& device = j["opencl_device"];
  EXPECT_GE(device["compute_units"], 1);
  EXPECT_FALSE(device["driver"].get<std::string>().empty());
  EXPECT_EQ(err_.find("This device is no GPU") != std::string::npos, device["kind"] != "GPU")
      << err_;
  EXPECT_EQ(j["casts"].size() + j["not_run"].size(), 6u);
  for (const json& cast : j["casts"]) expect_cast(cast, device["bit_exact"]);
  const json& last = j["casts"].back();
  EXPECT_EQ(last["through"], "bvh");
  EXPECT_EQ(last["rays"], 4096);
}

TEST_F(BenchGpu, MeshFile_IsMeasured) {
  const json j = figures({"--quick", "--mesh", CDE_SOURCE_DIR "/meshes/icosphere.ply"});
  ASSERT_TRUE(j.is_object());
  EXPECT_EQ(j["mesh"], "icosphere.ply");
  EXPECT_EQ(j["triangles"], 1280);
  write("one.obj", kOneTriangle);
  EXPECT_EQ(figures({"--quick", "--mesh", "one.obj"})["triangles"], 1);
}

TEST_F(BenchGpu, EmptyMesh_IsRefused) {
  write("empty.obj", "v 0 0 0\nv 1 0 0\n");
  refused({"bench", "gpu", "--mesh", "empty.obj"}, "empty.obj");
  refused({"bench", "gpu", "--mesh", "none.obj"}, "none.obj");
}

TEST_F(BenchGpu, List_HasTheDevices) {
  const Ran text = cde({"bench", "gpu", "--list"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_TRUE(has(text.out, "OpenCL device 0"));
  EXPECT_TRUE(has(text.out, "compute units"));
  const Ran ran = cde({"bench", "--list", "--json"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  const json devices = json::parse(ran.out)["opencl_devices"];
  ASSERT_GE(devices.size(), 1u);
  EXPECT_TRUE(has(text.out, devices[0]["name"].get<std::string>()));
}

TEST_F(BenchGpu, UnknownDevice_IsRefusedWithTheList) {
  refused({"bench", "gpu", "--opencl-device", "abacus"},
          "--opencl-device is 'abacus'; expected the number or a part of the name of one of: 0 ");
  refused({"reproduce", "--opencl-device", "abacus"}, "--opencl-device is 'abacus'");
}

/// A number chooses among several devices. Two PoCL devices are there only if PoCL is.
TEST_F(BenchGpu, SeveralDevices_AreChosenByNumber) {
  const std::vector<std::string> two = {"POCL_DEVICES=basic pthread"};
  const json devices = json::parse(cde({"bench", "--list", "--json"}, two).out)["opencl_devices"];
  if (devices.size() < 2) GTEST_SKIP() << "one OpenCL device: no choice";
  const std::size_t last = devices.size() - 1;
  const Ran ran = cde({"bench", "gpu", "--quick", "--json", "-q", "--mesh", "terrain:4,4,1",
                       "--opencl-device", std::to_string(last)},
                      two);
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(json::parse(ran.out)["gpu"]["opencl_device"]["name"], devices[last]["name"]);
}

/// Without a device of OpenCL the section says what is missing, also in a build without OpenCL.
class BenchNoGpu : public Cli {};

TEST_F(BenchNoGpu, NoPlatform_IsNamed) {
  if (baseline::has_opencl() && shell("OCL_ICD_VENDORS=none \"$CDE\" bench --list").status == 0)
    GTEST_SKIP() << "the OpenCL loader ignores OCL_ICD_VENDORS";
  const std::string text = baseline::has_opencl()
                               ? "no OpenCL platform is installed; expected a driver in "
                                 "/etc/OpenCL/vendors (for a CPU, Debian: pocl-opencl-icd)"
                               : "cde-bench was built without OpenCL; expected ocl-icd-opencl-dev";
  for (const char* words : {"bench gpu", "bench --list", "bench rays --opencl-device 0"}) {
    const Ran ran = shell(std::string("OCL_ICD_VENDORS=none \"$CDE\" ") + words);
    EXPECT_EQ(ran.status, 2) << words;
    EXPECT_TRUE(has(ran.err, text)) << words;
  }
}

TEST_F(BenchNoGpu, OptionsWithoutEffect_AreRefused) {
  refused({"bench", "rays", "--mesh", "terrain"}, "--mesh needs only the section gpu");
  refused({"bench", "fp", "--opencl-device", "0"}, "--opencl-device needs the section gpu");
  refused({"bench", "rays", "--list"}, "--list needs only the section gpu");
  refused({"bench", "--list", "--quick"}, "--list");
}

}  // namespace
}  // namespace cde::testing
