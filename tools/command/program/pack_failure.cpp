// SPDX-License-Identifier: Apache-2.0
#include "program/pack_failure.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cde/support/json_text.hpp"
#include "cde/support/process.hpp"
#include "cde/support/progress.hpp"
#include "cde/support/shell_word.hpp"
#include "options/typed.hpp"
#include "options/values.hpp"
#include "program/programs.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Answers requests {"rerun": FILE, "which": OPTIONS} until the child sends {"folder": ...,
/// "missing": ...}.
Json converse(process::Conversation& child, const Failure& failure) {
  child.write(json_text(to_json(failure), -1));
  while (const auto line = child.read()) {
    const Json asked = Json::parse(*line);
    if (!asked.contains("rerun")) return asked;
    Json answer;
    try {
      answer = {{"same", failure.rerun(asked["rerun"].get<std::string>(),
                                       trace_options_from_json(asked["which"]))}};
    } catch (const Error& e) {
      answer = {{"error", e.what()}};
    }
    child.write(json_text(answer, -1));
  }
  return {{"error", "cde-explain ended without an answer"}};
}

}  // namespace

void BundleRequest::check(bool compares, const std::string& option) const {
  if (named && !compares) cannot_combine("--bundle", option);
}

void add_bundle_options(CLI::App& verb, BundleRequest& request) {
  new_folder_value(
      verb.add_option("--bundle", request.folder,
                      "Where a wrong answer is packed: waves around it, the line of RTL "
                      "where card and reference first differ, commands that repeat it. An "
                      "existing folder stays; the next one is FOLDER-2")
          ->capture_default_str()
          ->each([&request](const std::string&) { request.named = true; }),
      "FOLDER");
  verb.add_flag_callback(
      "--no-bundle", [&request] { request.wanted = false; }, "Do not pack a wrong answer");
  excludes(verb, "--bundle", {"--no-bundle"});
}

std::string packed(const BundleRequest& request, bool quiet, const Failure& failure) {
  if (!request.wanted) return "";
  try {
    const Progress busy("packing the failure", quiet);
    process::Conversation child({program_file("cde-explain"), "pack", request.folder});
    const Json answer = converse(child, failure);
    (void)child.wait();
    if (answer.contains("error"))
      return fmt::format("\nnot packed:  {}", answer["error"].get<std::string>());
    const auto missing = answer["missing"].get<std::string>();
    return fmt::format("\npacked in:   {}{}", shell_word(answer["folder"].get<std::string>()),
                       missing.empty() ? "" : fmt::format(", incomplete: {}", missing));
  } catch (const Error& e) {
    return fmt::format("\nnot packed:  {}", e.what());
  }
}

}  // namespace cde::cli
