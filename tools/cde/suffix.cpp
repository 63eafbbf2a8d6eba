#include "suffix.hpp"

#include <filesystem>

namespace cde::cli {

namespace fs = std::filesystem;

Suffix suffix_of(const std::string& path) {
  if (path == "-" || path.starts_with("/dev/") || path.starts_with("/proc/")) return {"", true};
  std::error_code failed;
  const auto status = fs::status(path, failed);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
    return {"", true};
  fs::path name(path);
  // Links one by one: the file that the last one names need not be there yet.
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(name, failed)); ++links)
    name = name.parent_path() / fs::read_symlink(name, failed);
  return {name.extension().string(), false};
}

}  // namespace cde::cli
