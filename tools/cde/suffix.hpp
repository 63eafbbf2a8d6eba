#pragma once
#include <string>

namespace cde::cli {

/// The suffix of an output's name (".csv"), of a symbolic link that of its target; empty for what
/// has no name to go by: "-", a device, a FIFO, a descriptor such as /dev/stdout.
struct Suffix {
  std::string text;
  bool nameless = false;
};
[[nodiscard]] Suffix suffix_of(const std::string& path);

}  // namespace cde::cli
