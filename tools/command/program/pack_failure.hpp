// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/check/failure.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// The options --bundle and --no-bundle of a verb.
struct BundleRequest {
  std::string folder = "cde-failure";
  bool wanted = true;
  bool named = false;  ///< --bundle named the folder

  /// Error kUsage if a folder is named but nothing is compared, because of `option`.
  void check(bool compares, const std::string& option) const;
};
void add_bundle_options(CLI::App& verb, BundleRequest& request);

/// Packs a failure with `cde-explain pack`, which asks this process to repeat it. Returns a line
/// for the end of the error message: where the failure is packed, or why it is not. The line is
/// empty if packing is not wanted.
[[nodiscard]] std::string packed(const BundleRequest& request, bool quiet, const Failure& failure);

}  // namespace cde::cli
