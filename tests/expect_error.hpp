// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "cde/support/error.hpp"

namespace cde::testing {

/// Expects that the statement throws Error with this code and a message that contains `text`.
template <typename Statement>
void expect_error(ErrorCode code, const std::string& text, Statement statement) {
  try {
    statement();
    ADD_FAILURE() << "no error; expected one with '" << text << "'";
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos)
        << "message: " << e.what() << "\nlacks: " << text;
  }
}

}  // namespace cde::testing
