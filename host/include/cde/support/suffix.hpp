// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace cde {

/// The suffix of an output's name: ".csv", also for "A.CSV". For a symbolic link it is the suffix
/// of the target. It is empty for "-" and for a descriptor such as /dev/stdout.
struct Suffix {
  std::string text;
  bool nameless = false;  ///< "-", a descriptor, a device or a FIFO: any suffix, or none, will do
  std::string target;     ///< target of a symbolic link, else empty
};
[[nodiscard]] Suffix suffix_of(const std::string& path);

/// Error kUsage: "--out is 'x.png'; its name must end in .html". For a link the message names its
/// target.
[[noreturn]] void wrong_suffix(std::string_view option, const std::string& path,
                               std::string_view may_be);

/// The same, unless the output's name ends in `must_be`, says nothing, or is empty.
void check_suffix(std::string_view option, const std::string& path, std::string_view must_be);

}  // namespace cde
