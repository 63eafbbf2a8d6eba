// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "accuracy/names.hpp"
#include "cde/accuracy/picture.hpp"
#include "cde/accuracy/saved_sweep.hpp"
#include "cde/image/camera.hpp"

namespace cde::cli {

/// The page of a sweep over configurations, with a section per pair: accuracy against time, wrong
/// decisions, errors by family, all figures, and profiles if there are any. Charts also show
/// without scripts.
[[nodiscard]] std::string accuracy_html(const SavedSweep& sweep, const Target& target);

/// The page of wrong pixels of a mesh: one picture per pipe and, with WebGL, points on the mesh in
/// 3-D.
[[nodiscard]] std::string pictures_html(const std::vector<PictureAccuracy>& rows,
                                        const Resolution& size, const std::string& name,
                                        const Mesh& mesh);

}  // namespace cde::cli
