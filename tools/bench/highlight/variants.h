#pragma once
/// The same object in other forms, which should not change the chosen lights.

#include <span>
#include <string>

#include "core/scene/scene.h"

namespace luxrig {

struct HighlightVariant {
  Scene scene;
  Mat3 rotation = Mat3::Identity();  ///< rotates directions of the object to those of the variant
};

/// rotate, translate, scale, decimate, noise
[[nodiscard]] std::span<const char* const> highlight_variant_kinds();

/// rotate     about an axis that lies in no plane of the bins
/// translate  by hundreds of diagonals, as in map coordinates
/// scale      to a hundredth
/// decimate   to half its triangles, by collapsing short edges
/// noise      white, along the normals, with a standard deviation of 0.1 % of the diagonal
[[nodiscard]] HighlightVariant highlight_variant(const Scene& object, const std::string& kind);

/// Collapses edges to their middles, shortest first, until `triangles` are left or no edge can go. Skips an edge that
/// would flip a triangle or tear the surface.
[[nodiscard]] Scene decimated(const Scene& object, std::size_t triangles);

}  // namespace luxrig
