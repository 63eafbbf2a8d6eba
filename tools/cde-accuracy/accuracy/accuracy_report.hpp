// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/names.hpp"
#include "cde/accuracy/cost.hpp"
#include "cde/accuracy/picture.hpp"
#include "cde/accuracy/scene_accuracy.hpp"
#include "cde/accuracy/simulated.hpp"
#include "cde/accuracy/sweep.hpp"

/// Text output of `cde accuracy`.
namespace cde::cli {

/// A pipe with all its measurements.
struct AccuracyRow {
  Measured measured;
  Cost cost;
  std::vector<Simulated> simulated;  ///< one per back end; empty without --check
};

/// Tables of at most 120 columns with one line per pipe. With `by_family`, one line per family
/// follows it.
[[nodiscard]] std::string accuracy_tables(const std::vector<AccuracyRow>& rows, bool by_family,
                                          bool markdown);
[[nodiscard]] nlohmann::ordered_json accuracy_json(const std::vector<AccuracyRow>& rows);

/// A table in Markdown: the promise of each pipe, whether it was kept, and the excused cases.
[[nodiscard]] std::string promise_table(const std::vector<AccuracyRow>& rows);

[[nodiscard]] std::string picture_table(const std::vector<PictureAccuracy>& rows, bool markdown);
[[nodiscard]] std::string scene_table(const std::vector<SceneAccuracy>& rows, double clock_hz,
                                      bool markdown);

/// Three digits in at most seven characters: "0.412", "12.3", "3120", "1.2e5", "inf".
[[nodiscard]] std::string compact(double value);

}  // namespace cde::cli
