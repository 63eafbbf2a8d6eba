// SPDX-License-Identifier: Apache-2.0
// Which OpenCL device is chosen, and what a device is called.
#include <gtest/gtest.h>

#include <vector>

#include "baselines/baseline_opencl.hpp"
#include "expect_error.hpp"

namespace cde::testing {
namespace {

using baseline::choose_opencl_device;
using baseline::OpenClDevice;

std::vector<OpenClDevice> machine() {
  std::vector<OpenClDevice> all(3);
  all[0].platform = "Portable Computing Language", all[0].name = "pthread-x 2", all[0].kind = "CPU";
  all[1].platform = "Maker", all[1].name = "Fast 1000", all[1].kind = "GPU", all[1].number = 1;
  all[2].platform = "Maker", all[2].name = "Fast 2000", all[2].kind = "GPU", all[2].number = 2;
  return all;
}

TEST(OpenClChoice, WithoutAName_IsTheFirstGpu) {
  EXPECT_EQ(choose_opencl_device(machine(), "").name, "Fast 1000");
  const auto all = machine();
  EXPECT_EQ(choose_opencl_device(std::span(all).first(1), "").name, "pthread-x 2");
}

TEST(OpenClChoice, NameOrNumber_ChoosesADevice) {
  EXPECT_EQ(choose_opencl_device(machine(), "fast 2").number, 2u);
  EXPECT_EQ(choose_opencl_device(machine(), "portable").number, 0u);
  EXPECT_EQ(choose_opencl_device(machine(), "2").name, "Fast 2000")
      << "the number, though another name contains 2";
}

TEST(OpenClChoice, OtherNames_AreRefusedWithTheList) {
  expect_error(ErrorCode::kUsage, "fits several devices: 1 Fast 1000 (GPU, Maker); 2 Fast 2000",
               [] { (void)choose_opencl_device(machine(), "maker"); });
  expect_error(ErrorCode::kUsage,
               "--opencl-device is 'slow'; expected the number or a part of the name of one of: 0 "
               "pthread-x 2 (CPU, Portable Computing Language)",
               [] { (void)choose_opencl_device(machine(), "slow"); });
}

TEST(OpenClChoice, Cpu_IsNeverCalledAGpu) {
  EXPECT_EQ(machine()[0].label(), "CPU pthread-x 2 through OpenCL");
  EXPECT_FALSE(machine()[0].is_gpu());
  EXPECT_EQ(machine()[0].short_label(), "CPU through OpenCL");
  EXPECT_EQ(machine()[1].label(), "GPU Fast 1000");
  EXPECT_EQ(machine()[1].short_label(), "GPU");
}

}  // namespace
}  // namespace cde::testing
