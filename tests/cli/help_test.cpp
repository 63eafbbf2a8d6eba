// SPDX-License-Identifier: Apache-2.0
// Texts about the command itself: help, versions, suggestions, manual pages, completions.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "../has.hpp"
#include "run_cde.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const Words kVerbs = {"accuracy", "advise", "cast",    "render",    "query",     "run",
                      "plan",     "bench",  "merge",   "reproduce", "inventory", "wave",
                      "doctor",   "fp",     "version", "help"};
/// Verbs of `cde wave`.
const Words kWaveVerbs = {"info", "ls",     "at",    "show", "find", "diff",
                          "stat", "export", "serve", "tui",  "tx",   "why"};

std::string contents(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// Words that begin with two hyphens.
std::set<std::string> long_options(const std::string& text) {
  static const std::regex option("--[a-z][a-z-]*");
  return {std::sregex_token_iterator(text.begin(), text.end(), option), {}};
}

/// The text under a heading of a help page.
std::string section(const std::string& text, const std::string& heading) {
  const std::size_t start = text.find("\n\n" + heading + "\n");
  if (start == std::string::npos) return "";
  return text.substr(start + 2, text.find("\n\n", start + 2) - start - 2);
}

/// The text of a section of a manual page.
std::string section_of_page(const std::string& page, const std::string& heading) {
  const std::size_t start = page.find(".SH " + heading + "\n");
  return start == std::string::npos ? "" : page.substr(start, page.find("\n.SH ", start) - start);
}

/// The first groups of all matches.
Words matches(const std::string& text, const std::string& pattern) {
  const std::regex entry(pattern);
  return {std::sregex_token_iterator(text.begin(), text.end(), entry, 1), {}};
}

/// The words of all verbs: {"cast"}, {"wave", "show"}.
std::vector<Words> all_verbs() {
  std::vector<Words> all;
  for (const std::string& verb : kVerbs) all.push_back({verb});
  for (const std::string& verb : kWaveVerbs) all.push_back({"wave", verb});
  return all;
}

class Help : public Cli {
 protected:
  /// The help of a verb without line breaks.
  std::string page_of(Words verb) {
    verb.emplace_back("--help");
    return cde(verb, {"COLUMNS=120"}).out;
  }
  /// Writes the manual pages of all programs, as the build does.
  void write_manuals() {
    for (const char* program : {"", "-wave", "-explain", "-accuracy", "-bench"}) {
      const Ran ran = shell(fmt::format("\"$CDE{}\" write-manual share", program));
      ASSERT_EQ(ran.status, 0) << program << ran.err;
    }
  }
};

TEST_F(Help, Versions_AreThoseOfTheBuild) {
  const Ran ran = cde({"--version"});
  EXPECT_EQ(cde({"version"}).out, ran.out);
  EXPECT_EQ(ran.status, 0);
  EXPECT_TRUE(std::regex_search(ran.out, std::regex("^cde [0-9]+\\.[0-9]+\\.[0-9]+")));
  for (const char* text : {"Verilator 5", "clang version", "GNU"}) EXPECT_TRUE(has(ran.out, text));
}

TEST_F(Help, VerbAndOption_PrintTheSameOnStdout) {
  EXPECT_EQ(cde({"help"}).out, cde({"--help"}).out);
  for (const std::string& verb : kVerbs) {
    SCOPED_TRACE(verb);
    const Ran asked = cde({"help", verb}), option = cde({verb, "--help"});
    EXPECT_EQ(asked.status, 0);
    EXPECT_EQ(option.status, 0);
    EXPECT_EQ(asked.out, option.out);
    EXPECT_EQ(asked.err + option.err, "");
    for (const char* part : {"\nUsage\n", "\nExamples\n", "\nExit status\n", "\nEnvironment\n"})
      EXPECT_TRUE(has(asked.out, part));
  }
}

/// The pages of all programs, each as the verb itself prints it.
TEST_F(Help, HelpAll_HasEveryVerbOfEveryProgram) {
  const Ran ran = cde({"--help-all"}, {"COLUMNS=120"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.err, "");
  EXPECT_TRUE(ran.out.starts_with(page_of({})));
  for (const Words& verb : all_verbs())
    EXPECT_NE(ran.out.find("\n" + page_of(verb)), std::string::npos)
        << fmt::format("{}", fmt::join(verb, " "));
  const Ran alone = shell("cp \"$CDE\" cde && ./cde --help-all");
  EXPECT_EQ(alone.status, 2) << "the other programs are missing";
  EXPECT_TRUE(has(alone.out, "cde cast MESH"));
  for (const char* program : {"cde-wave", "cde-explain", "cde-accuracy", "cde-bench"})
    EXPECT_TRUE(has(alone.err, fmt::format("cde: {} is not installed", program)));
}

TEST_F(Help, VerbOfAVerb_HasItsOwnPage) {
  const Ran ran = cde({"help", "wave", "info"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_EQ(ran.out, cde({"wave", "info", "--help"}).out);
  EXPECT_TRUE(has(ran.out, "cde wave info"));
}

/// The help of a verb lists its own exit statuses and variables, and so does its manual page.
TEST_F(Help, Pages_EndWithStatusesAndVariables) {
  write_manuals();
  const std::string status = "\n  ([0-9]+(?: \\+ N)?) ", variable = "\n  ([A-Z_]+) ",
                    entry = "\\.TP\n.fB([^\\\\]*).fR";
  for (const Words& verb : all_verbs()) {
    SCOPED_TRACE(fmt::format("{}", fmt::join(verb, " ")));
    const std::string text = page_of(verb),
                      page = contents(folder_ /
                                      fmt::format("share/man/man1/cde-{}.1", fmt::join(verb, "-")));
    EXPECT_EQ(matches(section(text, "Exit status"), status),
              matches(section_of_page(page, "EXIT STATUS"), entry));
    EXPECT_EQ(matches(section(text, "Environment"), variable),
              matches(section_of_page(page, "ENVIRONMENT"), entry));
  }
  const auto statuses = [&](const Words& verb) {
    return matches(section(page_of(verb), "Exit status"), status);
  };
  EXPECT_EQ(statuses({"cast"}), (Words{"0", "2", "3", "4", "128 + N"}));
  EXPECT_EQ(statuses({"doctor"}), (Words{"0", "1", "2", "128 + N"}));
  EXPECT_EQ(statuses({"plan"}), (Words{"0", "2", "128 + N"}));
  EXPECT_EQ(statuses({"wave", "ls"}), (Words{"0", "2", "128 + N"}));
  EXPECT_EQ(statuses({"wave", "diff"}), (Words{"0", "1", "2", "128 + N"}));
  const auto variables = [&](const Words& verb) {
    return matches(section(page_of(verb), "Environment"), variable);
  };
  EXPECT_EQ(variables({"wave", "show"}),
            (Words{"CDE_READ_MEMORY", "CDE_READ_SECONDS", "COLUMNS", "NO_COLOR"}));
  EXPECT_EQ(variables({"wave", "ls"}), (Words{"CDE_READ_MEMORY", "CDE_READ_SECONDS", "NO_COLOR"}));
  EXPECT_EQ(variables({"advise"}), (Words{"CDE_SHARE", "CDE_COSTS", "NO_COLOR"}));
  EXPECT_EQ(variables({"query"}), (Words{"CDE_CACHE", "CDE_MODELS", "CDE_SHARE", "CDE_CLANG",
                                         "CDE_MARCH", "CDE_ASSERT", "NO_COLOR"}));
  EXPECT_TRUE(has(section(page_of({"cast"}), "Environment"), "CDE_READ_MEMORY"));
}

/// Options of a verb stand under "Options" or under other headings. Manual pages have the same
/// headings.
TEST_F(Help, Headings_HaveAtMostEightOptions) {
  write_manuals();
  constexpr std::size_t kMost = 8;
  const std::string option = "\n  (?:-[a-z], )?(--[a-z-]+)";
  for (const Words& verb : all_verbs()) {
    SCOPED_TRACE(fmt::format("{}", fmt::join(verb, " ")));
    const std::string text = page_of(verb), upto = text.substr(0, text.find("\nExamples\n"));
    const std::size_t all = matches(upto, option).size();
    std::size_t grouped = 0;
    Words headings;
    for (const std::string& heading : matches(upto, "\n\n([A-Z][^\n]*)(?=\n)")) {
      const std::size_t options = matches(section(text, heading), option).size();
      EXPECT_LE(options, kMost) << heading;
      EXPECT_FALSE(all > kMost && heading == "Options");
      grouped += options;
      if (options != 0) headings.push_back(heading);
    }
    EXPECT_EQ(grouped, all);
    const Words in_page =
        matches(contents(folder_ / fmt::format("share/man/man1/cde-{}.1", fmt::join(verb, "-"))),
                "\n\\.SS ([^\n]*)");
    EXPECT_EQ(in_page, headings.size() > 1 ? headings : Words());
  }
}

/// Defaults stand in square brackets after the text.
TEST_F(Help, Defaults_StandInSquareBrackets) {
  const std::regex other(
      "\\((?:on|off|all|default [^)]*|stdout|[0-9,.]+|the terminal's|[A-Z]+\\.run)\\)|"
      " if (?:it is )?not given|\\[\\[");
  for (const Words& verb : all_verbs()) {
    const std::string text = std::regex_replace(page_of(verb), std::regex("\\s+"), " ");
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, other))
        << fmt::format("{}: {}", fmt::join(verb, " "), found.str());
  }
  const std::string cast = std::regex_replace(page_of({"cast"}), std::regex("\\s+"), " ");
  EXPECT_TRUE(has(cast, "none is far from its triangle [on]"));
  EXPECT_TRUE(has(cast, "checked against every triangle [on, rays:64]"));
}

/// Lines fit the terminal, except examples, which stay whole so that users can copy them.
TEST_F(Help, Lines_FitTheTerminal) {
  for (const unsigned columns : {60u, 80u, 100u}) {
    std::size_t longest = 0;
    for (const std::string& verb : kVerbs) {
      std::istringstream text(
          cde({"help", verb}, {fmt::format("COLUMNS={}", columns), "TERM=xterm"}).out);
      for (std::string line; std::getline(text, line);) {
        EXPECT_EQ(line.find('\033'), std::string::npos) << "colour in a file";
        if (line.starts_with("    ") && line.find("cde ") != std::string::npos) continue;
        // A list of words without blanks is not broken either.
        if (line.find('|') == std::string::npos) {
          EXPECT_LE(line.size(), columns) << line;
        }
        longest = std::max(longest, line.size());
      }
    }
    EXPECT_GT(longest, columns - 10) << "lines break too early";
  }
}

/// Every verb has at least two examples, and their options exist.
TEST_F(Help, Examples_UseExistingOptions) {
  for (const Words& words : all_verbs()) {
    const std::string verb = fmt::format("{}", fmt::join(words, " "));
    SCOPED_TRACE(verb);
    const std::string text = page_of(words);
    const std::size_t start = text.find("\nExamples\n"), stop = text.find("\nExit status\n");
    const std::string examples = text.substr(start, stop - start);
    static const std::regex command("\n    ");
    EXPECT_GE(std::distance(std::sregex_iterator(examples.begin(), examples.end(), command), {}),
              2);
    std::set<std::string> known = long_options(text.substr(0, start));
    if (verb == "help" || verb == "version") {
      const std::string all = cde({"--help"}).out;
      known = long_options(all.substr(0, all.find("\nExamples\n")));
    }
    if (verb == "wave") {
      known = long_options(page_of({"cast"}));
      for (const std::string& inner : kWaveVerbs)
        known.merge(long_options(page_of({"wave", inner})));
    }
    for (const std::string& option : long_options(examples))
      EXPECT_TRUE(known.count(option) || option == "--help-all") << option;
  }
}

/// The first example of cde wave makes the file of all others; other.fst is a cast of other rays.
TEST_F(Help, WaveExamples_Run) {
  const auto examples_of = [&](const Words& verb) {
    return matches(section(page_of(verb), "Examples"), "\n    (cde [^\n]*)");
  };
  const auto run = [&](const std::string& command) {
    SCOPED_TRACE(command);
    const auto before = files();
    const Ran ran = shell("cde() { \"$CDE\" \"$@\"; }\n" + command);
    EXPECT_EQ(ran.status, command.starts_with("cde wave diff") ? 1 : 0) << ran.err;
    EXPECT_TRUE(ran.out != "" || files() != before);
  };
  const std::string cast =
      examples_of({"wave"}).at(0) + " --lanes 4 --algorithm moller --exact-card -q";
  run(std::regex_replace(cast, std::regex("waves.fst"), "other.fst"));
  run(std::regex_replace(cast, std::regex("4x4"), "4x3"));
  for (const std::string& verb : kWaveVerbs) {
    const Words commands = examples_of({"wave", verb});
    EXPECT_GE(commands.size(), 2u) << verb;
    if (verb == "tui") continue;  // needs a terminal
    for (const std::string& command : commands) run(command);
  }
}

TEST_F(Help, Misspellings_GetSuggestions) {
  const auto says = [&](const Words& words, const std::string& text) {
    const Ran ran = cde(words);
    EXPECT_EQ(ran.status, 2);
    EXPECT_EQ(ran.out, "");
    EXPECT_TRUE(has(ran.err, text));
  };
  says({"csat"}, "no verb 'csat'; did you mean cast?");
  says({"doc"}, "did you mean doctor?");
  says({"zzz"}, "no verb 'zzz'; there are: cast, render, query, run");
  says({"help", "qurey"}, "did you mean query?");
  says({"cast", "x.ply", "--szie", "4x4", "--grdi", "4x4"},
       "cde cast has no option '--szie'; did you mean --size?");
  says({"cast", "x.ply", "--grdi=4x4", "--szie", "4x4"},
       "cde cast has no option '--grdi'; did you mean --grid?");
  says({"run", "x.toml", "--frobnicate"}, "`cde run --help` lists them");
  says({"plan", "one.toml", "two.toml"}, "cde plan takes no argument 'two.toml'");
  says({}, "cde VERB");
}

/// Every option of every verb is in its manual page and in the completions of the three shells. The
/// command itself writes these files.
TEST_F(Help, FormerNames_NameTheNewOnes) {
  const auto says = [&](const std::vector<std::string>& args, const std::string& text) {
    const Ran ran = cde(args);
    EXPECT_EQ(ran.status, 2);
    EXPECT_TRUE(has(ran.err, text)) << ran.err;
  };
  says({"query", "obb-cylinder", "--budget", "9"}, "no option '--budget'; it is now --iterations");
  says({"accuracy", "--budgets", "9"}, "no option '--budgets'; it is now --iterations");
  says({"query", "obb-obb", "--facet-interval", "3"}, "it is now --sat-interval");
  says({"accuracy", "--verdicts"}, "no option '--verdicts'; it is now --filters");
  says({"bench", "hierarchy"}, "no section 'hierarchy'; it is now bvh");
  for (const auto& [former, now] :
       {std::pair{"CDE_BITSTREAMS", "CDE_MODELS"}, std::pair{"CDE_PRICES", "CDE_COSTS"}}) {
    ::setenv(former, "/tmp", 1);
    says({"fp", "add", "1", "1"},
         fmt::format("{0}: this variable is now {1}; unset it and set {1}", former, now));
    ::unsetenv(former);
  }
}

TEST_F(Help, ManualAndCompletions_HaveEveryOption) {
  write_manuals();
  EXPECT_FALSE(has(cde({"--help"}).out, "write-manual")) << "write-manual is hidden";
  const fs::path share = folder_ / "share";
  const std::string bash = contents(share / "bash-completion/completions/cde"),
                    zsh = contents(share / "zsh/site-functions/_cde"),
                    fish = contents(share / "fish/vendor_completions.d/cde.fish");
  for (const std::string& verb : kVerbs) {
    SCOPED_TRACE(verb);
    std::string text = cde({"help", verb}).out;
    std::string page = contents(share / fmt::format("man/man1/cde-{}.1", verb));
    page = std::regex_replace(page, std::regex("\\\\-"), "-");
    EXPECT_TRUE(page.starts_with(fmt::format(".TH cde-{} 1", verb)));
    const std::string options = text.substr(0, text.find("\nExamples\n"));
    static const std::regex first("\n  (-[a-z], )?(--[a-z-]+)");
    for (std::sregex_iterator at(options.begin(), options.end(), first), end; at != end; ++at) {
      const std::string option = (*at)[2];
      EXPECT_TRUE(has(page, option));
      EXPECT_TRUE(has(bash, option));
      EXPECT_TRUE(has(zsh, option));
      EXPECT_TRUE(has(fish, "-l " + option.substr(2))) << option;
    }
  }
}

/// Completions of bash for partly typed words.
TEST_F(Help, PartialWords_AreCompletedInBash) {
  write_manuals();
  write("mesh.ply", "");
  const auto offers = [&](const std::string& typed) {
    const std::string script = fmt::format(
        "cd '{}' && . share/bash-completion/completions/cde && COMP_WORDS=({}) && "
        "COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)) && compopt() {{ :; }} && _cde && "
        "printf '%s ' \"${{COMPREPLY[@]}}\"",
        folder_.string(), typed);
    std::ofstream(folder_ / "script") << script;
    std::FILE* pipe = ::popen(fmt::format("bash '{}/script' 2>&1", folder_.string()).c_str(), "r");
    std::string text;
    for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    ::pclose(pipe);
    return text;
  };
  EXPECT_EQ(offers("cde ca"), "cast ");
  EXPECT_EQ(offers("cde cast --alg"), "--algorithm ");
  EXPECT_EQ(offers("cde cast --mode n"), "nearest ");
  EXPECT_EQ(offers("cde cast --mode = f"), "farthest ");
  EXPECT_EQ(offers("cde cast me"), "mesh.ply ");
  EXPECT_EQ(offers("cde query sphere-s"), "sphere-sphere ");
  EXPECT_EQ(offers("cde help inv"), "inventory ");
  EXPECT_EQ(offers("cde wa"), "wave ");
  EXPECT_EQ(offers("cde wave sh"), "show ");
  EXPECT_EQ(offers("cde wave show --wi"), "--window ");
  EXPECT_EQ(offers("cde wave diff --align c"), "cycle ");
  EXPECT_EQ(offers("cde cast mesh.ply --size ''"), " ");
}

/// groff reports no problem. Skipped if groff is not installed.
TEST_F(Help, ManualPages_AreWellFormed) {
  if (std::system("command -v groff >/dev/null 2>&1") != 0) GTEST_SKIP() << "needs groff";
  write_manuals();
  for (const auto& page : fs::directory_iterator(folder_ / "share/man/man1")) {
    const std::string log = folder_ / "log";
    const std::string command =
        fmt::format("groff -man -Tutf8 -ww -z '{}' 2>'{}'", page.path().string(), log);
    EXPECT_EQ(std::system(command.c_str()), 0) << page.path();
    EXPECT_EQ(contents(log), "") << page.path();
  }
}

}  // namespace
}  // namespace cde::testing
