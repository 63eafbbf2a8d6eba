// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/names.hpp"
#include "cde/accuracy/picture.hpp"
#include "cde/accuracy/price.hpp"
#include "cde/accuracy/scene_accuracy.hpp"
#include "cde/accuracy/simulated.hpp"
#include "cde/accuracy/sweep.hpp"

/// What `cde accuracy` says.
namespace cde::cli {

/// A pipe with all that was found of it.
struct AccuracyRow {
  Measured measured;
  Price price;
  std::vector<Simulated> simulated;  ///< one per back end; empty if it was not asked for
};

/// Tables of at most 120 columns, one line per pipe, and with `by_family` one line per family below
/// it.
[[nodiscard]] std::string accuracy_tables(const std::vector<AccuracyRow>& rows, bool by_family,
                                          bool markdown);
[[nodiscard]] nlohmann::ordered_json accuracy_json(const std::vector<AccuracyRow>& rows);

/// In Markdown: what is promised of each pipe, whether it was kept, and what was excused.
[[nodiscard]] std::string promise_table(const std::vector<AccuracyRow>& rows);

[[nodiscard]] std::string picture_table(const std::vector<PictureAccuracy>& rows, bool markdown);
[[nodiscard]] std::string scene_table(const std::vector<SceneAccuracy>& rows, double clock_hz,
                                      bool markdown);

/// Three digits in at most seven characters: "0.412", "12.3", "3120", "1.2e5", "inf".
[[nodiscard]] std::string compact(double value);

}  // namespace cde::cli
