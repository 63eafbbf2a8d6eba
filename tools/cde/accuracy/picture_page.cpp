// SPDX-License-Identifier: Apache-2.0
// The wrong pixels of a mesh as a page.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "accuracy/accuracy_page.hpp"
#include "accuracy/accuracy_report.hpp"
#include "cde/image/image.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

/// In the order of PixelKind.
constexpr std::array<std::array<std::uint8_t, 3>, 5> kColours = {
    {{236, 238, 240}, {176, 184, 192}, {208, 48, 60}, {36, 100, 200}, {226, 140, 20}}};

std::string png_of(const PictureAccuracy& row, const Resolution& size) {
  Image image;
  image.size = size;
  for (const PixelKind kind : row.pixels)
    image.pixels.push_back(kColours.at(static_cast<std::size_t>(kind)));
  const std::string bytes = png_bytes(image);
  return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

std::string picture(const PictureAccuracy& row, const Resolution& size) {
  const PixelCounts& c = row.of_scene;
  const Interval95 share = wilson(c.wrong(), row.rays);
  const std::string what = fmt::format(
      "{}: {} of {} pixels wrong ({}..{} a million): {} hit where nothing is, {} miss what is "
      "there, "
      "{} show another triangle",
      row.pipe.name(), c.wrong(), grouped(row.rays), compact(1e6 * share.low),
      compact(1e6 * share.high), c.false_hits, c.false_misses, c.other);
  return fmt::format(
      "<figure class=\"pixels\"><img src=\"data:image/png;base64,{}\" width=\"{}\" height=\"{}\" "
      "alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
      png_of(row, size), size.width, size.height, escaped(what), escaped(what));
}

}  // namespace

std::string pictures_html(const std::vector<PictureAccuracy>& rows, const Resolution& size,
                          const std::string& mesh) {
  std::string body = fmt::format(
      "<main>\n<header><h1>Wrong pixels of {}</h1>\n<p class=\"lead\">{} by {} rays against {} "
      "triangles, by the mirror reference of each pipe and by exact arithmetic on the mesh as it "
      "is "
      "given.</p></header>\n<p class=\"note\">Grey: right, light where nothing is hit. Red: a hit "
      "where nothing is. Blue: nothing where a hit is. Orange: another triangle than the nearest, "
      "beyond the band.</p>\n<div class=\"controls choose\" data-of=\"format\" "
      "data-label=\"Format\" hidden></div>\n",
      escaped(mesh), size.width, size.height, rows.empty() ? "0" : grouped(rows.front().triangles));
  std::vector<std::string> formats;
  for (const PictureAccuracy& row : rows)
    if (std::ranges::find(formats, row.pipe.format.name()) == formats.end())
      formats.push_back(row.pipe.format.name());
  for (const std::string& format : formats) {
    body += fmt::format(
        "<section data-choice=\"format\" data-name=\"{0}\"><h2>{0}</h2>\n<div class=\"gallery\">\n",
        format);
    for (const PictureAccuracy& row : rows)
      if (row.pipe.format.name() == format) body += picture(row, size);
    body += "</div></section>\n";
  }
  body += "</main>\n";
  return page("Wrong pixels of " + mesh, body, nlohmann::ordered_json::object(),
              {&kAccuracyScript});
}

}  // namespace cde::cli
