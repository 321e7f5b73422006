#pragma once
/// The same object in other words: what chosen lights should not mind.

#include <span>
#include <string>

#include "core/scene/scene.h"

namespace luxrig {

struct HighlightVariant {
  Scene scene;
  Mat3 rotation = Mat3::Identity();  ///< directions of the variant are these, turned
};

/// rotate, translate, scale, decimate, noise
[[nodiscard]] std::span<const char* const> highlight_variant_kinds();

/// rotate     about an axis that lies in no plane of the bins
/// translate  by hundreds of diagonals, as in map coordinates
/// scale      to a hundredth
/// decimate   to half its triangles, by collapsing short edges
/// noise      white, along the normals, with a standard deviation of 0.1 % of the diagonal
[[nodiscard]] HighlightVariant highlight_variant(const Scene& object, const std::string& kind);

/// Edges are collapsed to their middles, the shortest first, unless that would turn a triangle over or tear the
/// surface, until `triangles` are left or none can go.
[[nodiscard]] Scene decimated(const Scene& object, std::size_t triangles);

}  // namespace luxrig
