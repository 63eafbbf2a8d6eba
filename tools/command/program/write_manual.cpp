// SPDX-License-Identifier: Apache-2.0
// The hidden verb that the build calls to write manual pages and completions.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cde/support/input_file.hpp"
#include "cde/support/json_text.hpp"
#include "options/completions.hpp"
#include "options/help.hpp"
#include "options/manual.hpp"
#include "output/output.hpp"
#include "program/program.hpp"
#include "program/programs.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void write(const fs::path& path, const std::string& text) {
  std::error_code failed;  // opening the file reports the failure
  fs::create_directories(path.parent_path(), failed);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

/// Makes programs that are built at the same time write one after the other.
class Lock {
 public:
  explicit Lock(const fs::path& folder) {
    std::error_code failed;
    fs::create_directories(folder, failed);
    fd_ = ::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (fd_ >= 0) ::flock(fd_, LOCK_EX);
  }
  ~Lock() {
    if (fd_ >= 0) ::close(fd_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  int fd_ = -1;
};

bool is_of(const std::string& verb, const std::string& program) {
  const auto all = all_verbs();
  return std::any_of(all.begin(), all.end(),
                     [&](const VerbEntry& e) { return e.verb == verb && e.program == program; });
}

/// The verbs of all programs that have written their tables, in the order of the help.
VerbTable all_programs(const fs::path& tables) {
  VerbTable all{"cde", "", {}};
  std::vector<VerbTable> verbs;
  for (const auto& entry : fs::directory_iterator(tables)) {
    if (entry.path().extension() != ".json") continue;
    VerbTable table = table_from_json(Json::parse(read_file(entry.path().string())));
    if (table.name == "cde") {
      if (entry.path().stem() == "cde") all.options = table.options;
      for (VerbTable& verb : table.verbs)
        if (is_of(verb.name, entry.path().stem().string())) verbs.push_back(std::move(verb));
    } else {  // "cde wave": a verb with verbs
      table.name = table.name.substr(table.name.find(' ') + 1);
      table.text = table.text.substr(table.text.find(": ") + 2);
      verbs.push_back(std::move(table));
    }
  }
  for (const VerbEntry& entry : all_verbs())
    for (VerbTable& verb : verbs)
      if (verb.name == entry.verb) all.verbs.push_back(std::move(verb));
  return all;
}

/// The layout of /usr/share, which `cmake --install` copies.
void write_all(const CLI::App& app, const std::string& file, const fs::path& share) {
  const bool has_page = file == "cde" || app.get_name() != "cde";
  if (has_page) write(share / fmt::format("man/man1/{}.1", page_name(app)), manual_page(app));
  for (const CLI::App* verb : shown_verbs(app))
    if (verb_elsewhere(verb->get_name()) == nullptr || app.get_name() != "cde")
      write(share / fmt::format("man/man1/{}.1", page_name(*verb)), manual_page(*verb));
  const fs::path tables = share / "cde/commands";
  const Lock lock(tables);
  write(tables / (file + ".json"), json_text(to_json(table_of(app))) + '\n');
  const VerbTable all = all_programs(tables);
  write(share / "bash-completion/completions/cde", bash_completion(all));
  write(share / "zsh/site-functions/_cde", zsh_completion(all));
  write(share / "fish/vendor_completions.d/cde.fish", fish_completion(all));
}

}  // namespace

void add_write_manual(CLI::App& app) {
  auto folder = std::make_shared<std::string>();
  CLI::App* pages = app.add_subcommand(
      "write-manual", "Write manual pages and completions into a folder like /usr/share");
  pages->group("");
  folder_value(pages->add_option("folder", *folder, "Folder")->required(), "FOLDER");
  pages->callback([&app, folder] { write_all(app, this_program(), *folder); });
}

}  // namespace cde::cli
