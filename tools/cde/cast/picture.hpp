// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cast/job.hpp"
#include "cde/image/image.hpp"

namespace cde::cli {

/// Sets the rays of the picture that --camera, --grid, --size and --up name, or of a picture that
/// shows the whole mesh. Without a given size the number of triangles limits it. Error kUsage.
void aim(const RaySource& source, CastJob& job);

/// Error kUsage for an unknown suffix of a picture, before any work starts.
void check_picture_names(const PictureFiles& files);

/// The default name of a picture in the current folder: bunny.render.png for "bunny.ply". Other
/// programs do not use such names.
[[nodiscard]] std::string own_picture_name(const std::string& mesh);

/// Casts the rays of a picture's second pass.
using CastAgain = std::function<void(const CastJob& job, const RecordSink& take)>;

/// Makes the requested pictures from records.
class CastPicture {
 public:
  /// Error kCapacity if the machine has no memory for pictures of that size.
  CastPicture(const CastTask& task, const CastJob& job);
  void add(std::span<const Record> records);
  /// With --shadows: casts a ray from each hit to the sun.
  void look_at_sun(const CastAgain& cast);
  /// Writes the files. A picture with the default name is also shown on the terminal.
  void write() const;

 private:
  [[nodiscard]] PixelHits hits() const;
  [[nodiscard]] Image sunlit() const;
  /// Unit normal towards the eye, of the triangle that pixel i shows.
  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const;
  void write_depth() const;
  void write_normals() const;
  void write_indices() const;

  const CastTask& o_;
  const CastJob& job_;
  bool shaded_, faces_;  // data that pixels need: the whole record, the triangle
  std::vector<std::uint8_t> hit_, shadow_;
  std::vector<float> t_;
  std::vector<std::uint32_t> index_;
  std::vector<Eigen::Vector3f> point_;
};

/// A picture in characters for a terminal. In colour a character shows two pixels; otherwise
/// letters show brightness.
[[nodiscard]] std::string as_text(const Image& image, unsigned columns, bool colour);

}  // namespace cde::cli
