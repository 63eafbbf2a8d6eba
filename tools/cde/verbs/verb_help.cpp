// SPDX-License-Identifier: Apache-2.0
// cde help, and the hidden verb with which the build writes manual pages and completions.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "command/help.hpp"
#include "command/manual.hpp"
#include "command/values.hpp"
#include "output/output.hpp"
#include "verbs/verbs.hpp"

namespace cde::cli {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  std::error_code failed;  // what comes of it, the file says
  fs::create_directories(path.parent_path(), failed);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

/// The layout of /usr/share, which `cmake --install` copies.
void write_all(const CLI::App& app, const fs::path& share) {
  write(share / "man/man1/cde.1", manual_page(app));
  for (const CLI::App* verb : shown_verbs(app))
    write(share / fmt::format("man/man1/cde-{}.1", verb->get_name()), manual_page(*verb));
  write(share / "bash-completion/completions/cde", bash_completion(app));
  write(share / "zsh/site-functions/_cde", zsh_completion(app));
  write(share / "fish/vendor_completions.d/cde.fish", fish_completion(app));
}

void print_help(const CLI::App& app, const std::string& verb) {
  std::string text;
  if (verb.empty()) {
    text = app.get_formatter()->make_help(&app, "", CLI::AppFormatMode::Normal);
  } else {
    for (const CLI::App* one : shown_verbs(app))
      if (one->get_name() == verb) text = one->help();
  }
  OutputFile out("-");
  out.write(text);
  out.commit();
}

}  // namespace

void add_help(CLI::App& app) {
  auto verb_name = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("help", "Print what the program or a verb of it does");
  std::vector<std::string> verbs;
  for (const CLI::App* one : shown_verbs(app)) verbs.push_back(one->get_name());
  named(verb->add_option("verb", *verb_name, "A verb (all of the program)"), verbs, "VERB", "verb");
  verb->callback([&app, verb_name] { print_help(app, *verb_name); });

  auto folder = std::make_shared<std::string>();
  CLI::App* pages = app.add_subcommand(
      "write-manual", "Write manual pages and completions into a folder like /usr/share");
  pages->group("");
  folder_value(pages->add_option("folder", *folder, "Folder")->required(), "FOLDER");
  pages->callback([&app, folder] { write_all(app, *folder); });
}

}  // namespace cde::cli
