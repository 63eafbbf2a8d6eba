// SPDX-License-Identifier: Apache-2.0
#pragma once

/// CLI11 by name: its headers take 6 s a file, and most files that pass an option on need none of
/// them.
namespace CLI {
class App;
class Option;
class FormatterBase;
}  // namespace CLI
