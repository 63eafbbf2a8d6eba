// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace cde::testing {

struct Ran {
  int status = -1;  ///< exit status, or 128 + signal
  std::string out, err;
};

/// The content of a file; empty if it cannot be read.
[[nodiscard]] std::string bytes_of(const std::filesystem::path& path);

/// A mesh of one triangle, as OBJ.
inline constexpr const char* kOneTriangle = "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n";

/// The end of a scene's text: a query of the object "rays" against `secondaries`.
[[nodiscard]] std::string hit_query(const std::string& secondaries);

/// JSON keys that docs/reference/json.md explains.
[[nodiscard]] const std::set<std::string>& documented_keys();
/// All keys in JSON text: one object, or one per line. The last line may follow other text.
[[nodiscard]] std::set<std::string> keys_of(const std::string& text);

/// Limits the size of every file that the command writes, while this object lives.
class FileLimit {
 public:
  explicit FileLimit(std::uint64_t bytes);
  ~FileLimit();
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

/// A temporary folder in which the command runs.
class Cli : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Runs `cde` with these words and additional environment variables NAME=VALUE. With --json the
  /// printed keys must be documented.
  [[nodiscard]] Ran cde(const std::vector<std::string>& words,
                        const std::vector<std::string>& environment = {});
  /// Expects that the command ends with this status and message, and writes no file.
  void refused(const std::vector<std::string>& words, const std::string& text, int status = 2);
  /// The same, where the whole message is "cde: " and the text.
  void refused_saying(const std::vector<std::string>& words, const std::string& text);
  /// Runs a bash script in which "$CDE" is the command.
  [[nodiscard]] Ran shell(const std::string& script);
  /// Starts the command and does not wait.
  [[nodiscard]] pid_t start(const std::vector<std::string>& words,
                            const std::vector<std::string>& environment = {});
  [[nodiscard]] Ran finish(pid_t child);
  /// Waits, without pauses, until a file is in the folder; false if the command ends first.
  [[nodiscard]] bool wait_for_file(pid_t child) const;

  std::string write(const std::string& name, const std::string& text) const;
  [[nodiscard]] std::string read(const std::string& name) const;
  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(folder_ / name);
  }
  /// Names in the folder, sorted.
  [[nodiscard]] std::vector<std::string> files() const;

  std::filesystem::path folder_;

 private:
  [[nodiscard]] pid_t start_program(const char* program, const std::vector<std::string>& words,
                                    const std::vector<std::string>& environment);
  std::filesystem::path logs_;
};

}  // namespace cde::testing
