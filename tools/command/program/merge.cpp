// SPDX-License-Identifier: Apache-2.0
// cde merge: makes a run from the journals of its shards.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cde/jobs/journal.hpp"
#include "cde/jobs/work_distributor.hpp"
#include "cde/support/error.hpp"
#include "cde/support/message.hpp"
#include "cde/support/output_file.hpp"
#include "options/values.hpp"
#include "program/program.hpp"
#include "program/programs.hpp"

namespace cde::cli {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

/// A shard's command without the options that make it a shard.
Words words_of_whole(const Journal& journal) {
  Words whole;
  const auto words = journal.run().at("words").get<Words>();
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto is = [&](const std::string& option) {
      if (words[i] == option) return ++i, true;  // skips its value
      return words[i].starts_with(option + "=");
    };
    if (!is("--shard") && !is("--resume")) whole.push_back(words[i]);
  }
  return whole;
}

/// The words of a journal are run as a command, so only verbs that work in shards are allowed.
void check_words(const Journal& journal) {
  const Json words = journal.run().value("words", Json());
  const auto is_word = [](const Json& w) {
    return w.is_string() && w.get_ref<const std::string&>().find('\0') == std::string::npos;
  };
  const bool all_text = words.is_array() && !words.empty() && std::ranges::all_of(words, is_word);
  if (all_text && journal.run().value("verb", Json()) == words[0] && is_distributed(words[0]))
    return;
  throw Error(ErrorCode::kFile, fmt::format("cde merge: {}: \"words\" is not the command of a run",
                                            printable_name(journal.path())));
}

void run(const std::vector<std::string>& files, const CommandRun& again) {
  std::vector<std::unique_ptr<Journal>> journals;
  for (const std::string& file : files) {
    auto journal = std::make_unique<Journal>("cde merge", file, Journal::Use::kRead);
    if (!journal->run().is_object())
      throw Error(ErrorCode::kUsage,
                  fmt::format("cde merge: {} is not finished; its command has not begun",
                              printable_name(file)));
    check_words(*journal);
    for (const auto& [number, place] : journal->chunks()) (void)journal->read(number);
    journals.push_back(std::move(journal));
  }
  Json of_all;
  for (const auto& [key, value] : journals.front()->run().items())
    if (key != "shard" && key != "words") of_all[key] = value;
  for (const auto& journal : journals) journal->check_run(of_all);
  const Words words = words_of_whole(*journals.front());
  if (const VerbEntry* entry = verb_elsewhere(words[0])) {
    Words merge = {"merge"};
    merge.insert(merge.end(), files.begin(), files.end());
    exit_code = other_program(*entry, merge);
    return;
  }
  OutputFile::buffer_stdout();  // written output cannot be undone
  WorkDistributor::instance().merge(std::move(journals));
  exit_code = again(words);
}

}  // namespace

void add_merge(CLI::App& app, const CommandRun& again) {
  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = app.add_subcommand(
      "merge",
      "Merge the journals of shards (--shard) into the whole run: write the files and the summary "
      "that the whole command would have written. Run it in the folder of that command: it reads "
      "the meshes and rays again, and rays of - from stdin. It simulates nothing");
  file_value(verb->add_option("journal", *files, "Journals (--resume) of all shards, in any order")
                 ->required(),
             "JOURNAL");
  verb->callback([files, again] { run(*files, again); });
}

}  // namespace cde::cli
