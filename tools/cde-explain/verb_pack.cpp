// SPDX-License-Identifier: Apache-2.0
// cde-explain pack: packs a failure that another program describes on stdin (pack_failure.cpp).
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "cde/explain/bundle.hpp"
#include "cde/support/json_text.hpp"
#include "cde/support/output_file.hpp"
#include "options/values.hpp"
#include "output/streams.hpp"
#include "verbs.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// The program that asks for the package has ended, perhaps by a signal. Not an Error, for which
/// pack() would keep the folder.
struct AskerEnded {};

Json next_line() {
  std::string line;
  if (!std::getline(std::cin, line)) throw AskerEnded();
  if (nested_deeper(line))
    throw Error(ErrorCode::kBadInput, "stdin: JSON is nested in more than 200 levels");
  try {
    return Json::parse(line);
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::kBadInput, std::string("stdin: ") + e.what());
  }
}

void pack_failure(const std::string& folder, Failure failure) {
  failure.rerun = [](const std::string& file, const TraceOptions& which) {
    try {
      print_json({{"rerun", file}, {"which", to_json(which)}}, -1);
    } catch (const StdoutError&) {
      throw AskerEnded();
    }
    const Json answer = next_line();
    if (answer.contains("error"))
      throw Error(ErrorCode::kDevice, answer["error"].get<std::string>());
    return answer.at("same").get<bool>();
  };
  try {
    const Packed packed = pack(folder, failure);
    print_json({{"folder", packed.folder.string()}, {"missing", packed.missing}}, -1);
  } catch (const Error& e) {
    print_json({{"error", e.what()}}, -1);
  }
}

}  // namespace

void add_pack(CLI::App& app) {
  auto folder = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("pack", "Pack a failure, described on stdin, into a folder");
  verb->group("");
  new_folder_value(verb->add_option("folder", *folder, "Folder")->required(), "FOLDER");
  verb->callback([folder] {
    std::optional<Failure> failure;
    try {
      failure = failure_from_json(next_line());
      pack_failure(*folder, std::move(*failure));
    } catch (const AskerEnded&) {
      if (!failure)
        throw Error(ErrorCode::kBadInput,
                    "stdin is empty; expected a line of JSON about a failure");
    }
  });
}

}  // namespace cde::cli
