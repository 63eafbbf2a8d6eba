// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "cde/check/failure.hpp"
#include "options/cli_fwd.hpp"

namespace cde::cli {

/// --bundle and --no-bundle of a verb.
struct BundleRequest {
  std::string folder = "cde-failure";
  bool wanted = true;
  bool named = false;  ///< the folder, by --bundle

  /// Error kUsage if a folder is named and `option` says that nothing is compared.
  void check(bool compares, const std::string& option) const;
};
void add_bundle_options(CLI::App& verb, BundleRequest& request);

/// Packs a failure by `cde-explain pack`, which asks this process to repeat it. Returns a line for
/// the end of the error: where the failure is packed, or why it is not. Empty if it is not wanted.
[[nodiscard]] std::string packed(const BundleRequest& request, bool quiet, const Failure& failure);

}  // namespace cde::cli
