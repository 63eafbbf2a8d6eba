// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "accuracy/names.hpp"
#include "cde/accuracy/kept.hpp"
#include "cde/accuracy/picture.hpp"
#include "cde/image/camera.hpp"

namespace cde::cli {

/// The price list: accuracy against time, wrong decisions, errors by family and all figures of a
/// sweep, a section per pair, with the profiles if it has any. Charts are there without scripts.
[[nodiscard]] std::string accuracy_html(const KeptSweep& sweep, const Target& target);

/// Where the wrong pixels of a mesh are: a picture a pipe, and with WebGL points on the mesh in
/// 3-D.
[[nodiscard]] std::string pictures_html(const std::vector<PictureAccuracy>& rows,
                                        const Resolution& size, const std::string& name,
                                        const Mesh& mesh);

}  // namespace cde::cli
