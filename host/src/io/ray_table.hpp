// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

#include "cde/geometry/primitives.hpp"
#include "support/table_form.hpp"

namespace cde {

/// Columns of rays: ox, oy, oz, dx, dy, dz, tmin, tmax.
[[nodiscard]] const text::TableForm& ray_table();

/// Reads the rays of a text. `name` is the file's name for messages.
[[nodiscard]] std::vector<Ray> rays_in_text(std::string_view bytes, std::string_view name);

}  // namespace cde
