// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Forward declarations of CLI11. Its headers take long to compile, and most files only pass an
/// option on.
namespace CLI {
class App;
class Option;
class FormatterBase;
}  // namespace CLI
