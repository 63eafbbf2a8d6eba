// SPDX-License-Identifier: Apache-2.0
#include "cde/support/suffix.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "cde/support/error.hpp"
#include "cde/support/message.hpp"

namespace cde {

namespace fs = std::filesystem;

Suffix suffix_of(const std::string& path) {
  if (path == "-") return {"", true, ""};
  std::error_code failed;
  const auto status = fs::status(path, failed);
  const bool special =
      fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
  // Descriptors have no name with a suffix. But /dev/shm/a.vcd is a file.
  for (const char* folder : {"/dev/fd/", "/dev/std", "/proc/"})
    if (path.starts_with(folder)) return {"", true, ""};
  fs::path name(path);
  // Follows links one by one: the target of the last link need not exist yet.
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(name, failed)); ++links)
    name = name.parent_path() / fs::read_symlink(name, failed);
  std::string text = name.extension().string();
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return {text, special, name == fs::path(path) ? "" : name.string()};
}

void wrong_suffix(std::string_view option, const std::string& path, std::string_view may_be) {
  const Suffix name = suffix_of(path);
  throw Error(
      ErrorCode::kUsage,
      name.target.empty()
          ? fmt::format("{} is {}; its name must end in {}", option, in_quotes(path), may_be)
          : fmt::format("{} is {}, a link to {}, whose name must end in {}", option,
                        in_quotes(path), in_quotes(name.target), may_be));
}

void check_suffix(std::string_view option, const std::string& path, std::string_view must_be) {
  if (path.empty()) return;
  const Suffix name = suffix_of(path);
  if (!name.nameless && name.text != must_be) wrong_suffix(option, path, must_be);
}

}  // namespace cde
