// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cast/job.hpp"
#include "cde/image/image.hpp"

namespace cde::cli {

/// Rays of the picture that --camera, --grid, --size and --up ask for, or of one that shows the
/// mesh; of a size that the triangles allow if none is given. Error kUsage.
void aim(const RaySource& source, CastJob& job);

/// Complains about suffixes of pictures before anything slow.
void check_picture_names(const PictureFiles& files);

/// "bunny.ply" shows itself as bunny.render.png in the folder where the command runs. No file of
/// another program is called so.
[[nodiscard]] std::string own_picture_name(const std::string& mesh);

/// Casts the rays of a picture's second look.
using CastAgain = std::function<void(const CastJob& job, const RecordSink& take)>;

/// Records become the pictures that were asked for.
class CastPicture {
 public:
  /// Error kCapacity if the machine has no memory for pictures of that size.
  CastPicture(const CastTask& task, const CastJob& job);
  void add(std::span<const Record> records);
  /// From each hit a ray to the sun, with --shadows.
  void look_at_sun(const CastAgain& cast);
  /// Writes the files. On a terminal, one of its own accord shows itself there, too.
  void write() const;

 private:
  [[nodiscard]] PixelHits hits() const;
  [[nodiscard]] Image sunlit() const;
  /// Unit normal of the triangle that pixel i shows, towards the eye.
  [[nodiscard]] Eigen::Vector3f normal(std::size_t i) const;
  void write_depth() const;
  void write_normals() const;
  void write_indices() const;

  const CastTask& o_;
  const CastJob& job_;
  bool shaded_, faces_;  // what pixels need: all of a hit, its triangle
  std::vector<std::uint8_t> hit_, shadow_;
  std::vector<float> t_;
  std::vector<std::uint32_t> index_;
  std::vector<Eigen::Vector3f> point_;
};

/// A picture of characters for a terminal: two pixels each in colour, else light as letters.
[[nodiscard]] std::string as_text(const Image& image, unsigned columns, bool colour);

}  // namespace cde::cli
