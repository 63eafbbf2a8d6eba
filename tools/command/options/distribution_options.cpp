// SPDX-License-Identifier: Apache-2.0
#include "options/distribution_options.hpp"

#include <CLI/CLI.hpp>

#include "cde/support/error.hpp"
#include "options/values.hpp"

namespace cde::cli {

void add_distribution_options(CLI::App& verb, DistributionOptions& o) {
  auto* resume = file_value(
      verb.add_option(
          "--resume", o.resume,
          "Journal file: keeps finished chunks; chunks that it already has are not computed again"),
      "FILE");
  resume->each([](const std::string& file) {
    if (file == "-")
      throw Error(ErrorCode::kUsage,
                  "--resume is -; it must be a file, because the journal is read and written");
  });
  text_value(verb.add_option("--shard", o.shard,
                             "Run only part I of N, into the journal of --resume; cde merge joins "
                             "the journals of all parts")
                 ->capture_default_str(),
             "I/N", [](const std::string& text) { (void)parse_shard(text); })
      ->needs(resume);
}

}  // namespace cde::cli
