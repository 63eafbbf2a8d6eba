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
  if (fs::is_symlink(fs::symlink_status(name, failed))) {
    const fs::path target = fs::weakly_canonical(name, failed);
    if (!failed) name = target;
  }
  return {name.extension().string(), false};
}

}  // namespace cde::cli
