// SPDX-License-Identifier: Apache-2.0
// A model with another function table than the driver's is refused before any function is called.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>

#include "../has.hpp"
#include "cde/card/board.hpp"
#include "cde/card/fp_unit.hpp"
#include "cde/card/pair_unit.hpp"
#include "cde/model/model.hpp"
#include "cde/support/error.hpp"

namespace cde {
namespace {

using Openers = std::map<std::string, std::function<void(const std::string&)>>;

const Openers& openers() {
  static const Openers all = {
      {"board", [](const std::string& file) { (void)Board::open({}, {.file = file}); }},
      {"card",
       [](const std::string& file) { (void)Board::open({.bus = Bus::kCycle}, {.file = file}); }},
      {"pair_unit", [](const std::string& file) { PairUnit(SimulationModel::load(file, 0), {}); }},
      {"fp_unit", [](const std::string& file) { FpUnit{SimulationModel::load(file, 0)}; }}};
  return all;
}

/// Errors for opening a file as each kind of model.
void expect_errors(const std::string& file, const std::map<std::string, std::string>& texts,
                   ErrorCode code) {
  for (const auto& [kind, text] : texts) {
    try {
      openers().at(kind)(file);
      ADD_FAILURE() << kind << " was opened";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << kind;
      EXPECT_TRUE(has(e.what(), text)) << kind << ": " << e.what();
    }
  }
}

TEST(ModelTables, AnotherVersion_IsRefused) {
  const std::string text = "C interface version ";
  expect_errors(CDE_LATER_TABLES,
                {{"board", text}, {"card", text}, {"pair_unit", text}, {"fp_unit", text}},
                ErrorCode::kConfiguration);
}

TEST(ModelTables, AnotherSize_IsRefused) {
  const std::string text = " bytes; expected ";
  expect_errors(CDE_LONGER_TABLES,
                {{"board", text}, {"card", text}, {"pair_unit", text}, {"fp_unit", text}},
                ErrorCode::kConfiguration);
}

/// The same library with the driver's own numbers is accepted and called.
TEST(ModelTables, SameVersionAndSize_AreCalled) {
  expect_errors(CDE_OWN_TABLES,
                {{"board", "no memory for the card's models"},
                 {"card", "no memory for the card's models"},
                 {"fp_unit", "out of memory"}},
                ErrorCode::kDevice);
  expect_errors(CDE_OWN_TABLES, {{"pair_unit", "is not the requested ray-triangle unit"}},
                ErrorCode::kConfiguration);
}

}  // namespace
}  // namespace cde
