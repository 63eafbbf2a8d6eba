// SPDX-License-Identifier: Apache-2.0
// A page of the wrong pixels of a mesh.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

#include "accuracy/accuracy_page.hpp"
#include "accuracy/accuracy_report.hpp"
#include "cde/image/image.hpp"
#include "page/page.hpp"

namespace cde::cli {
namespace {

/// Colours in the order of PixelKind.
constexpr std::array<std::array<std::uint8_t, 3>, 5> kColours = {
    {{236, 238, 240}, {176, 184, 192}, {208, 48, 60}, {36, 100, 200}, {226, 140, 20}}};
constexpr std::size_t kFirstWrong = static_cast<std::size_t>(PixelKind::kFalseHit);

std::string png_of(const PictureAccuracy& row, const Resolution& size) {
  Image image;
  image.size = size;
  for (const PixelKind kind : row.pixels)
    image.pixels.push_back(kColours.at(static_cast<std::size_t>(kind)));
  const std::string bytes = png_bytes(image);
  return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// A sentence about the wrong pixels of a pipe.
std::string said(const PictureAccuracy& row) {
  const PixelCounts& c = row.of_scene;
  const Interval95 share = wilson(c.wrong(), row.rays);
  return fmt::format(
      "{}: {} of {} pixels wrong ({}..{} per million): {} false hits, {} false misses, {} show the "
      "wrong triangle",
      row.pipe.name(), c.wrong(), grouped(row.rays), compact(1e6 * share.low),
      compact(1e6 * share.high), c.false_hits, c.false_misses, c.other);
}

std::string picture(const PictureAccuracy& row, const Resolution& size) {
  const std::string what = said(row);
  return fmt::format(
      "<figure class=\"pixels\"><img src=\"data:image/png;base64,{}\" width=\"{}\" height=\"{}\" "
      "alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
      png_of(row, size), size.width, size.height, escaped(what), escaped(what));
}

/// The mesh and the wrong points of every pipe, for the view in 3-D.
nlohmann::ordered_json in_space(const std::vector<PictureAccuracy>& rows, const Mesh& mesh) {
  nlohmann::ordered_json json = {{"colours", nlohmann::ordered_json::array()},
                                 {"views", nlohmann::ordered_json::array()}};
  for (const char* colour : {"#ff6a4d", "#6cb2ff", "#ffb454"}) json["colours"].push_back(colour);
  for (const PictureAccuracy& row : rows) {
    if (row.wrong.empty()) continue;
    std::vector<float> at;
    std::vector<std::uint8_t> kinds;
    for (const WrongPoint& point : row.wrong) {
      at.insert(at.end(), point.at.begin(), point.at.end());
      kinds.push_back(
          static_cast<std::uint8_t>(static_cast<std::size_t>(point.kind) - kFirstWrong));
    }
    json["views"].push_back({{"name", row.pipe.name()},
                             {"text", said(row) + "."},
                             {"at", base64_of(at)},
                             {"kinds", base64_of(kinds)}});
  }
  if (json["views"].empty()) return json;  // no wrong point on the mesh
  std::vector<float> points;
  for (const Eigen::Vector3f& v : mesh.vertices) points.insert(points.end(), v.begin(), v.end());
  std::vector<std::uint32_t> corners;
  for (const auto& face : mesh.faces) corners.insert(corners.end(), face.begin(), face.end());
  json["points"] = base64_of(points);
  json["corners"] = base64_of(corners);
  return json;
}

/// The page's script shows this section if there is WebGL.
constexpr const char* kSpace =
    "<section id=\"in-space\" aria-label=\"In space\" hidden><h2>In space</h2>\n<figure><div "
    "class=\"stage\" id=\"stage\"></div><div class=\"controls\"><label>Pipe <select "
    "id=\"of-pipe\"></select></label></div><figcaption><span id=\"readout\"></span> Drag to turn, "
    "wheel to zoom.</figcaption></figure></section>\n";

}  // namespace

std::string pictures_html(const std::vector<PictureAccuracy>& rows, const Resolution& size,
                          const std::string& mesh_name, const Mesh& mesh) {
  std::string body = fmt::format(
      "<main>\n<header><h1>Wrong pixels of {}</h1>\n<p class=\"lead\">{} by {} rays against {} "
      "triangles: the mirror reference of each pipe, compared with exact arithmetic on the "
      "original mesh.</p></header>\n<p class=\"note\">Grey: right; light grey is a miss. Red: "
      "false hit. Blue: false miss. Orange: not the nearest triangle, beyond the band.</p>\n{}<div "
      "class=\"controls choose\" data-of=\"format\" data-label=\"Format\" hidden></div>\n",
      escaped(mesh_name), size.width, size.height,
      rows.empty() ? "0" : grouped(rows.front().triangles), kSpace);
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
  body += fmt::format(
      "<footer><details><summary>Software in this page</summary><pre>{}</pre></details></footer>\n"
      "</main>\n",
      escaped(kThreeLicence.text));
  return page("Wrong pixels of " + mesh_name, body, in_space(rows, mesh),
              {&kThreeScript, &kWrongScript, &kAccuracyScript});
}

}  // namespace cde::cli
