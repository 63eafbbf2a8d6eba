// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/support/output_file.hpp"

/// Files that OutputFile::remove_unfinished() removes when a signal ends the process. Private to
/// the library.
namespace cde {

/// The entry must stay in place until forget_unfinished().
void remember_unfinished(const NameInFolder& entry);
void forget_unfinished(const NameInFolder& entry);

}  // namespace cde
