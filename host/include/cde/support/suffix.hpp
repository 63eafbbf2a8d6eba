// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde {

/// The suffix of an output's name (".csv", also of "A.CSV"), of a symbolic link that of its target;
/// empty for what has no name to go by: "-", a device, a FIFO, a descriptor such as /dev/stdout.
struct Suffix {
  std::string text;
  bool nameless = false;
  std::string target;  ///< of a symbolic link, else empty
};
[[nodiscard]] Suffix suffix_of(const std::string& path);

/// Error kUsage: "--out is 'x.png'; its name must end in .html", or of a link, the name of its
/// target.
[[noreturn]] void wrong_suffix(std::string_view option, const std::string& path,
                               std::string_view may_be);

/// The same unless the output's name ends so, has no name to go by, or is empty.
void check_suffix(std::string_view option, const std::string& path, std::string_view must_be);

}  // namespace cde
