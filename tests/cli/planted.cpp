// SPDX-License-Identifier: Apache-2.0
#include "planted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "../rtl_copy.hpp"

namespace cde::testing {

namespace fs = std::filesystem;

Planted::Planted(const fs::path& folder, const std::string& file, const std::string& from,
                 const std::string& to)
    : share_(folder / "share"),
      // with assertions gates build faster
      environment_{"CDE_SHARE=" + share_.string(), "CDE_WERROR=0", "CDE_ASSERT=1"} {
  copy_rtl(CDE_SOURCE_DIR, share_);
  change(file, from, to);
}

void Planted::change(const std::string& file, const std::string& from, const std::string& to) {
  std::ifstream in(share_ / file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from << " is not in " << file;
  if (at == std::string::npos) return;
  line_ =
      1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
  text.replace(at, from.size(), to);
  std::ofstream(share_ / file) << text;
}

std::vector<std::string> faulty_card(const fs::path& folder) {
  const Planted fault(folder, "rtl/pipes/ray_triangle_moller.sv", "in_edges_uv & in_uv",
                      "in_edges_uv");
  std::vector<std::string> environment = fault.environment();
  environment.push_back("CDE_CACHE=" + (folder / "cache").string());
  return environment;
}

}  // namespace cde::testing
