// SPDX-License-Identifier: Apache-2.0
#include "run_cde.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "../has.hpp"

namespace cde::testing {
namespace {

namespace fs = std::filesystem;

fs::path new_folder() {
  std::string name = (fs::temp_directory_path() / "cde-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
  return name;
}

}  // namespace

std::string bytes_of(const fs::path& path) {
  std::ostringstream text;  // files of /proc may end while they are read
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string hit_query(const std::string& secondaries) {
  return "[[query]]\nname = \"hit\"\npair = \"ray-triangle\"\nprimaries = \"rays\"\nsecondaries = "
         "\"" +
         secondaries + "\"\n";
}

const std::set<std::string>& documented_keys() {
  static const std::set<std::string> keys = [] {
    std::set<std::string> found;
    std::istringstream lines(bytes_of(fs::path(CDE_SOURCE_DIR) / "docs/reference/json.md"));
    for (std::string line; std::getline(lines, line);) {
      static const std::regex key("`([A-Za-z_0-9]+)`");
      if (!line.starts_with('|')) continue;
      for (std::sregex_iterator at(line.begin(), line.end(), key), end; at != end; ++at)
        found.insert((*at)[1]);
    }
    return found;
  }();
  return keys;
}

std::set<std::string> keys_of(const std::string& text) {
  std::set<std::string> keys;
  const auto note = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    if (event == nlohmann::json::parse_event_t::key) keys.insert(value.get<std::string>());
    return true;
  };
  // One object over several lines, or one last line after other lines.
  const std::size_t begin = text.starts_with('{') ? 0 : text.rfind("\n{");
  if (begin == std::string::npos) return keys;
  if (nlohmann::json::parse(text.substr(begin), note, false).is_discarded()) keys.clear();
  return keys;
}

FileLimit::FileLimit(std::uint64_t bytes) {
  ::getrlimit(RLIMIT_FSIZE, &before_);
  const rlimit less = {bytes, before_.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &less);
}

FileLimit::~FileLimit() {
  ::setrlimit(RLIMIT_FSIZE, &before_);
}

void Cli::SetUp() {
  folder_ = new_folder();
  logs_ = new_folder();
}

void Cli::TearDown() {
  fs::remove_all(folder_);
  fs::remove_all(logs_);
}

pid_t Cli::start(const std::vector<std::string>& words,
                 const std::vector<std::string>& environment) {
  return start_program(CDE_COMMAND, words, environment);
}

Ran Cli::shell(const std::string& script) {
  return finish(start_program("/bin/bash", {"-c", script}, {"CDE=" + std::string(CDE_COMMAND)}));
}

pid_t Cli::start_program(const char* program, const std::vector<std::string>& words,
                         const std::vector<std::string>& environment) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  std::vector<char*> argv = {const_cast<char*>(program)};
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  for (const std::string& change : environment) {
    const auto equals = change.find('=');
    ::setenv(change.substr(0, equals).c_str(), change.substr(equals + 1).c_str(), 1);
  }
  const auto redirect = [&](const char* name, int fd) {
    ::dup2(::open((logs_ / name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), fd);
  };
  redirect("out", STDOUT_FILENO);
  redirect("err", STDERR_FILENO);
  if (::chdir(folder_.c_str()) != 0) ::_exit(126);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

Ran Cli::finish(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), bytes_of(logs_ / "out"),
          bytes_of(logs_ / "err")};
}

bool Cli::wait_for_file(pid_t child) const {
  while (files().empty()) {
    siginfo_t info{};  // WNOWAIT: finish() still needs the status
    ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT);
    if (info.si_pid == child) return !files().empty();
  }
  return true;
}

Ran Cli::cde(const std::vector<std::string>& words, const std::vector<std::string>& environment) {
  Ran ran = finish(start(words, environment));
  if (std::find(words.begin(), words.end(), "--json") == words.end()) return ran;
  for (const std::string& key : keys_of(ran.out))
    EXPECT_TRUE(documented_keys().contains(key)) << "docs/reference/json.md lacks the key " << key;
  return ran;
}

void Cli::refused(const std::vector<std::string>& words, const std::string& text, int status) {
  SCOPED_TRACE(fmt::format("{}", fmt::join(words, " ")));
  const auto before = files();
  const Ran ran = cde(words);
  EXPECT_EQ(ran.status, status) << ran.err;
  EXPECT_TRUE(has(ran.err, text));
  EXPECT_EQ(ran.out, "");
  EXPECT_EQ(files(), before);
}

void Cli::refused_saying(const std::vector<std::string>& words, const std::string& text) {
  const std::string all = "cde: " + text + "\n";
  refused(words, all);
  EXPECT_EQ(bytes_of(logs_ / "err"), all);
}

std::string Cli::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return name;
}

std::string Cli::read(const std::string& name) const {
  return bytes_of(folder_ / name);
}

std::vector<std::string> Cli::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace cde::testing
