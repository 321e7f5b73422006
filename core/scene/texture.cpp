#include "core/scene/texture.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr std::size_t kMaxTexels = 512;  // along a side
constexpr double kMaxSteps = 24;         // along the longest edge of a triangle

const std::array<double, 256>& srgb_table() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = linear_of_srgb(static_cast<double>(i) / 255);
    return out;
  }();
  return table;
}

}  // namespace

double linear_of_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Texture::Rows::Rows(std::size_t width, std::size_t height)
    : width_(width),
      height_(height),
      reduce_((std::max(width, height) + kMaxTexels - 1) / kMaxTexels),
      texture_(std::make_shared<Texture>()) {
  Level base;
  base.width = (width + reduce_ - 1) / reduce_;
  base.height = (height + reduce_ - 1) / reduce_;
  base.texels.assign(base.width * base.height, Vec3f::Zero());
  texture_->levels_.push_back(std::move(base));
}

void Texture::Rows::add(const unsigned char* pixels, std::size_t bytes_per_pixel) {
  const auto& linear = srgb_table();
  Level& base = texture_->levels_.front();
  const std::size_t rows_in_block = std::min(reduce_, height_ - row_ / reduce_ * reduce_);
  Vec3f* const texels = &base.texels[row_ / reduce_ * base.width];
  for (std::size_t block = 0; block < base.width; ++block) {
    const std::size_t end = std::min(width_, (block + 1) * reduce_);
    Vec3 sum = Vec3::Zero();
    for (std::size_t x = block * reduce_; x < end; ++x) {
      const unsigned char* const p = pixels + x * bytes_per_pixel;
      sum += Vec3(linear[p[0]], linear[p[1]], linear[p[2]]);
    }
    sum_ += sum;
    texels[block] += (sum / static_cast<double>((end - block * reduce_) * rows_in_block)).cast<float>();
  }
  ++row_;
}

std::shared_ptr<const Texture> Texture::Rows::finish() {
  texture_->mean_ = sum_ / static_cast<double>(width_ * height_);
  texture_->add_levels();
  return std::move(texture_);
}

void Texture::add_levels() {
  while (levels_.back().texels.size() > 1) {
    const Level& from = levels_.back();
    Level half;
    half.width = (from.width + 1) / 2;
    half.height = (from.height + 1) / 2;
    half.texels.reserve(half.width * half.height);
    for (std::size_t y = 0; y < half.height; ++y) {
      for (std::size_t x = 0; x < half.width; ++x) {
        const std::size_t right = std::min(2 * x + 1, from.width - 1), below = std::min(2 * y + 1, from.height - 1);
        half.texels.push_back((from.texels[2 * y * from.width + 2 * x] + from.texels[2 * y * from.width + right] +
                               from.texels[below * from.width + 2 * x] + from.texels[below * from.width + right]) /
                              4);
      }
    }
    levels_.push_back(std::move(half));
  }
}

Vec3 Texture::mean_over(const std::array<std::array<float, 2>, 3>& corners) const {
  using Vec2 = Eigen::Vector2d;
  const Vec2 a(corners[0][0], corners[0][1]), b(corners[1][0], corners[1][1]), c(corners[2][0], corners[2][1]);
  const double far = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  if (!(a.allFinite() && b.allFinite() && c.allFinite() && far < 1e6)) return mean_;
  for (const Level& level : levels_) {
    const Vec2 size(static_cast<double>(level.width), static_cast<double>(level.height));
    const double longest = std::max(
        {(b - a).cwiseProduct(size).norm(), (c - a).cwiseProduct(size).norm(), (c - b).cwiseProduct(size).norm()});
    if (longest > kMaxSteps) continue;
    // The centres of steps² equal parts of the triangle.
    const int steps = std::max(1, static_cast<int>(std::ceil(longest)));
    Vec3 sum = Vec3::Zero();
    const auto add = [&](double u, double v) {
      const Vec2 at = a + u * (b - a) + v * (c - a);
      const auto texel = [](double place, std::size_t count) {
        const double within = place - std::floor(place);
        return std::min(static_cast<std::size_t>(within * static_cast<double>(count)), count - 1);
      };
      sum += level.texels[texel(at.y(), level.height) * level.width + texel(at.x(), level.width)].cast<double>();
    };
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps - i; ++j) {
        add((i + 1.0 / 3) / steps, (j + 1.0 / 3) / steps);
        if (i + j < steps - 1) add((i + 2.0 / 3) / steps, (j + 2.0 / 3) / steps);
      }
    }
    return sum / (static_cast<double>(steps) * steps);
  }
  return mean_;
}

}  // namespace luxrig
