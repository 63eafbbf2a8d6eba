// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace cde {

/// The word, quoted so that a POSIX shell reads it back unchanged. A word with control characters
/// is quoted as $'...', which bash, zsh and ksh read, so that a terminal shows it on one line.
[[nodiscard]] std::string shell_word(const std::string& word);

}  // namespace cde
