// The patches of one cell: which surfaces are one patch, and which of them it lies on.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/goals/dicing.h"

namespace luxrig {
namespace {

/// A place behind the front one of its cell is in another slab. They are an eighth of a cell thick.
constexpr int kSlabs = 16;
constexpr float kSlabsPerCell = 8;
/// A surface in front counts if it has this share of the area of the largest slab. A bolt head does not hide a wall.
constexpr float kCounts = 0.25F;
constexpr float kParallel = 0.996F;   ///< cosine of 5 degrees
constexpr float kSamePlane = 0.001F;  ///< of a slab

struct Side {
  const DicedPiece* piece;
  float sign;
  [[nodiscard]] Vec3f normal() const { return sign * piece->normal; }
};

bool comes_first(const DicedPiece& a, const DicedPiece& b) {
  const auto key = [](const DicedPiece& p) {
    return std::array{-p.area_m2,   p.position_m.x(), p.position_m.y(), p.position_m.z(),
                      p.normal.x(), p.normal.y(),     p.normal.z()};
  };
  return key(a) < key(b);
}

int slab_of(const Side& side, const Vec3f& facing, const Vec3f& middle_m, float slab_m) {
  const float slab = std::floor((side.piece->position_m - middle_m).dot(facing) / slab_m) + kSlabs / 2;
  return std::clamp(static_cast<int>(slab), 0, kSlabs - 1);
}

/// The place of a side, or of the foremost one parallel to it, if it is the back of a sheet thinner than a slab.
Vec3f front_of(const Side& side, const std::vector<Side>& sides, float slab_m) {
  const Vec3f normal = side.normal();
  Vec3f place_m = side.piece->position_m;
  for (const Side& other : sides)
    if (other.normal().dot(normal) > kParallel) {
      const float before_m = (other.piece->position_m - place_m).dot(normal);
      if (before_m > kSamePlane * slab_m && before_m < slab_m) place_m = other.piece->position_m;
    }
  return place_m;
}

/// sides   that one patch stands for, the largest first
SurfacePatch patch_of(const std::vector<Side>& sides, const Vec3f& middle_m, float slab_m) {
  const Vec3f facing = sides.front().normal();
  std::array<double, kSlabs> area_m2{};
  for (const Side& side : sides) area_m2[slab_of(side, facing, middle_m, slab_m)] += side.piece->area_m2;
  const double largest_m2 = *std::max_element(area_m2.begin(), area_m2.end());
  int front = kSlabs - 1;
  while (area_m2[front] < kCounts * largest_m2) --front;

  Vec3 normal = Vec3::Zero(), moment = Vec3::Zero();
  double all_m2 = 0;
  for (const Side& side : sides) {
    const double size_m2 = side.piece->area_m2;
    all_m2 += size_m2;
    if (slab_of(side, facing, middle_m, slab_m) != front) continue;
    normal += size_m2 * side.normal().cast<double>();
    moment += size_m2 * side.piece->position_m.cast<double>();
  }
  const Vec3f mean_m = (moment / area_m2[front]).cast<float>();
  const Side* nearest = nullptr;
  float distance2_m2 = 0;
  for (const Side& side : sides) {
    if (slab_of(side, facing, middle_m, slab_m) != front) continue;
    const float from_mean2_m2 = (side.piece->position_m - mean_m).squaredNorm();
    if (nearest && from_mean2_m2 >= distance2_m2) continue;
    nearest = &side;
    distance2_m2 = from_mean2_m2;
  }
  return {front_of(*nearest, sides, slab_m), normal.normalized().cast<float>(), static_cast<float>(all_m2)};
}

}  // namespace

// Larger pieces come first, so the largest of a patch says which way it faces.
void append_patches_of_cell(std::span<DicedPiece> pieces, const Vec3f& cell_middle_m, double cell_m,
                            std::vector<SurfacePatch>& patches) {
  static const auto kCosine = static_cast<float>(std::cos(kOnePatch_rad));
  std::sort(pieces.begin(), pieces.end(), comes_first);
  std::vector<std::vector<Side>> by_orientation;
  for (const DicedPiece& piece : pieces) {
    for (const float sign : {1.0F, -1.0F}) {
      const Side side{&piece, sign};
      auto like = std::find_if(by_orientation.begin(), by_orientation.end(), [&](const std::vector<Side>& sides) {
        return sides.front().normal().dot(side.normal()) > kCosine;
      });
      if (like == by_orientation.end()) like = by_orientation.emplace(by_orientation.end());
      like->push_back(side);
    }
  }
  for (const std::vector<Side>& sides : by_orientation)
    patches.push_back(patch_of(sides, cell_middle_m, static_cast<float>(cell_m) / kSlabsPerCell));
}

}  // namespace luxrig
