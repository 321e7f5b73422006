#pragma once
/// Pictures on surfaces, in linear light: the mean reflectance of a triangle.

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// 8-bit sRGB (IEC 61966-2-1) to linear light, 0…1.
[[nodiscard]] double linear_of_srgb(double encoded);

class Texture {
 public:
  /// Takes rows of red, green, blue from the upper left, and makes a reduced copy of at most 512 x 512.
  class Rows {
   public:
    Rows(std::size_t width, std::size_t height);
    void add(const unsigned char* pixels, std::size_t bytes_per_pixel);
    [[nodiscard]] std::shared_ptr<const Texture> finish();

   private:
    std::size_t width_, height_, reduce_, row_ = 0;
    std::shared_ptr<Texture> texture_;
    Vec3 sum_ = Vec3::Zero();
  };

  [[nodiscard]] const Vec3& mean() const { return mean_; }
  /// Mean of the picture over a triangle. The picture repeats in both directions. Corners from the upper left, 1 = its
  /// size.
  [[nodiscard]] Vec3 mean_over(const std::array<std::array<float, 2>, 3>& corners) const;

 private:
  struct Level {
    std::size_t width = 0, height = 0;
    std::vector<Vec3f> texels;
  };
  void add_levels();

  std::vector<Level> levels_;  // each half the size of the one before, down to a single texel
  Vec3 mean_ = Vec3::Zero();
};

struct DecodedTexture {
  std::shared_ptr<const Texture> texture;  ///< null = not read
  std::string trouble;                     ///< why, for a message: "is of no known kind (WebP)"
};

/// Decodes a PNG or JPEG, told apart by content, not name; at most 64 million pixels.
[[nodiscard]] DecodedTexture decode_texture(std::string_view bytes);

}  // namespace luxrig
