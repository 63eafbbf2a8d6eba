// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Makes names of the library cde::accuracy visible without a prefix in this program.
namespace cde::accuracy {}
namespace cde::cli {
using namespace accuracy;
}  // namespace cde::cli
