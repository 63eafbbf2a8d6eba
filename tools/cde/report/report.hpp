// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "page/time_split.hpp"
#include "report/report_picture.hpp"
#include "report/report_scene.hpp"

/// `cde run --report`: a page about a run (docs/reference/scenes.md).
namespace cde::cli {

inline constexpr Resolution kPictureSize = {1200, 600};

/// Takes the frames of a run as they are simulated, and writes the page. The size of the page is
/// bounded: for a long run, the 3-D view has every 2nd, 4th, ... frame, and the charts have means
/// of several frames.
class Report {
 public:
  using Json = nlohmann::ordered_json;

  /// The scene must outlive the report.
  explicit Report(const Scene& scene);

  /// Takes records of a query in the current frame.
  void records(std::size_t query, std::span<const Record> records);
  /// Ends the current frame with the answers of its queries.
  void frame(std::uint32_t number, const std::vector<QueryFrame>& answers);
  /// The page. `run` is the content of run.json.
  [[nodiscard]] std::string html(const Json& run) const;

 private:
  struct Kept {
    std::vector<ShownHit> hits;
    std::vector<ShownHit>
        apart;  ///< misses of solids with a normal, as a heap with the farthest on top
    std::uint64_t left_out = 0;
    float least = NAN, most = NAN;  ///< signed distance of solids; T of the hits of rays
  };
  struct FrameResult {
    std::uint32_t number = 0;
    TimeSplit modelled;
    double card_seconds = 0, reference_seconds = 0;  ///< wall time
    std::uint64_t records = 0, hits = 0;
    std::vector<std::array<float, 2>> distances;  ///< per query: the least and the most
  };
  struct View {
    Json json;
    std::size_t bytes = 0;
  };

  void measure(const SceneQuery& query, const Record& record, Kept& kept) const;
  [[nodiscard]] bool keeps(const SceneQuery& query, const Record& record) const;
  [[nodiscard]] std::size_t stride_of_primaries(const SceneQuery& query) const;
  /// T of the farthest shown hit of every ray in the frame, by object; NaN without a hit.
  [[nodiscard]] std::vector<std::vector<float>> last_hits() const;
  /// Sets box and camera from the first frame.
  void frame_scene(const std::vector<ShownObject>& shown);
  void look(std::uint32_t frame, const std::vector<ShownObject>& shown);
  void thin_out();  ///< drops every other view
  [[nodiscard]] Json object_json(std::size_t object, const ShownObject& shown,
                                 const std::vector<float>& last);
  [[nodiscard]] Json points_json(std::size_t object, const std::vector<Eigen::Vector3f>& points);
  void draw(const std::vector<ShownObject>& shown, const std::vector<std::vector<float>>& last);
  [[nodiscard]] Eigen::Vector3f ray_end(const Ray& ray, float t) const;

  [[nodiscard]] Json data(const Json& run) const;
  [[nodiscard]] std::string view_html() const;
  [[nodiscard]] std::string legend_html() const;
  [[nodiscard]] std::string charts_html() const;
  [[nodiscard]] std::string distances_html() const;
  [[nodiscard]] std::string tables_html(const Json& run) const;
  [[nodiscard]] std::vector<std::string> notes() const;

  const Scene& scene_;
  SceneGeometry geometry_;
  std::vector<Kept> kept_;  ///< per query, of the current frame
  std::vector<FrameResult> frame_results_;
  std::vector<View> views_;  ///< of the frames 0, stride_, 2 stride_, ...
  std::vector<std::vector<Eigen::Vector3f>> first_points_;  ///< of meshes that deform, by object
  std::size_t stride_ = 1, view_bytes_ = 0;
  std::uint64_t hits_left_out_ = 0;
  bool with_itself_ = false;  ///< whether hits of objects with themselves were left out
  Eigen::AlignedBox3f box_;   ///< of the first frame
  Camera camera_;
  std::optional<std::string> picture_;  ///< PNG
};

}  // namespace cde::cli
