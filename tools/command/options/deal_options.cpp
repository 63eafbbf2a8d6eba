// SPDX-License-Identifier: Apache-2.0
#include "options/deal_options.hpp"

#include <CLI/CLI.hpp>

#include "cde/support/error.hpp"
#include "options/values.hpp"

namespace cde::cli {

void add_deal_options(CLI::App& verb, DealOptions& o) {
  auto* resume = file_value(
      verb.add_option("--resume", o.resume,
                      "Journal: finished chunks are kept there, and what is there is not computed "
                      "again"),
      "FILE");
  resume->each([](const std::string& file) {
    if (file == "-")
      throw Error(ErrorCode::kUsage, "--resume is read and written: it must be a file, not -");
  });
  text_value(verb.add_option("--shard", o.shard,
                             "Only part I of N of the run, into --resume; cde merge makes the "
                             "whole of the journals of all parts")
                 ->capture_default_str(),
             "I/N", [](const std::string& text) { (void)parse_shard(text); })
      ->needs(resume);
}

}  // namespace cde::cli
