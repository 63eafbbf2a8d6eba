// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "cde/support/output_file.hpp"

/// What OutputFile::remove_unfinished() removes when a signal ends the process. Private to the
/// library.
namespace cde {

enum class UnfinishedKind {
  kFile,
  kFolder,    ///< removed if it is empty
  kContents,  ///< all that is in the folder; the name is not used
};

/// The entry must stay in place until forget_unfinished() of the same kind.
void remember_unfinished(const NameInFolder& entry, UnfinishedKind kind = UnfinishedKind::kFile);
void forget_unfinished(const NameInFolder& entry, UnfinishedKind kind = UnfinishedKind::kFile);

/// Removes all that is in an open folder, by system calls that a signal handler may use.
void remove_contents(int folder) noexcept;

}  // namespace cde
