// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

namespace cde::wave {

/// Runs `work` in a child of this process, which then continues in its place. In the child this
/// returns, or throws, as `work` does. In the parent it waits for the child and returns its exit
/// status. The reader of Verilator's runtime may crash on a corrupt file. If the child thus ends
/// while it works, the parent throws error kFile, naming `file`.
///
/// ReadLimits limits the child's memory, and without `crashed` its processor time. Error kFile,
/// naming `file`, if it needs more.
///
/// `crashed` is for a child that changes state outside itself, such as terminal modes. The parent
/// runs it if a signal has ended the child. With it, signals that end a process are passed to the
/// child, which the parent outlives.
///
/// Returns -1 in the child.
[[nodiscard]] int guarded(const std::string& file, const std::function<void()>& work,
                          const std::function<void()>& crashed = {});

}  // namespace cde::wave
