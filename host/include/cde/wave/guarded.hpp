// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

namespace cde::wave {

/// Runs `work` in a child of this process, which then goes on in place of it: in the child this
/// returns, or throws, as `work` does. In the parent it returns the exit status of the child, once
/// that has ended. If the child ends while it works, because the reader of Verilator's runtime
/// crashed on a corrupt file, that is Error kFile in the parent, naming `file`.
///
/// `crashed` is for a child that changes what outlives it, as the modes of a terminal: the parent
/// runs it if a signal has ended the child. Signals that end a process are then for the child,
/// which the parent outlives.
///
/// -1 in the child.
[[nodiscard]] int guarded(const std::string& file, const std::function<void()>& work,
                          const std::function<void()>& crashed = {});

}  // namespace cde::wave
