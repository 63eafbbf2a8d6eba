// SPDX-License-Identifier: Apache-2.0
#include "planted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace cde::testing {

namespace fs = std::filesystem;

Planted::Planted(const fs::path& folder, const std::string& file, const std::string& from,
                 const std::string& to) {
  const fs::path share = folder / "share", source = CDE_SOURCE_DIR;
  fs::create_directories(share / "host/include/cde");
  for (const char* part : {"rtl", "verilator", "host/include/cde/contract"})
    fs::copy(source / part, share / part,
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  std::ifstream in(share / file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t at = text.find(from);
  environment_ = {"CDE_SHARE=" + share.string(), "CDE_WERROR=0"};
  EXPECT_NE(at, std::string::npos) << from << " is not in " << file;
  if (at == std::string::npos) return;
  line_ =
      1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
  text.replace(at, from.size(), to);
  std::ofstream(share / file) << text;
}

}  // namespace cde::testing
