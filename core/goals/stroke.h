#pragma once
/// What a person painted: a list of strokes is the document, from which the lux of every patch follows.
/// Source: thesis §5.3.

#include <string>
#include <vector>

#include "core/goals/surface_patches.h"

namespace luxrig {

enum class StrokeKind {
  brush,      ///< the patches within a radius of a path, as far as they belong together
  bucket,     ///< a whole group
  selective,  ///< those patches of a group to which this click is the nearest of all selective ones there
  eraser      ///< takes away the uppermost stroke at a place
};
/// Name in files.
[[nodiscard]] constexpr const char* name_of(StrokeKind kind) {
  constexpr const char* kNames[] = {"brush", "bucket", "selective", "eraser"};
  return kNames[static_cast<int>(kind)];
}

/// Ten times what the sun gives.
inline constexpr double kMaxStroke_lx = 1e6;

struct Stroke {
  StrokeKind kind = StrokeKind::bucket;
  std::vector<SurfacePlace> path;  ///< of a brush; otherwise one place
  double lux = 0;                  ///< 0…kMaxStroke_lx; an eraser has none
  double radius_m = 0;             ///< of a brush; 0 = only the patches that the path meets
  /// Share of the radius, 0…1, over which the stroke fades into what is painted below it. Where nothing is, it has its
  /// own lux up to the edge: there is nothing to fade into, and 0 lx would be a wish for darkness.
  double falloff = 0;
  bool operator==(const Stroke&) const = default;
};

}  // namespace luxrig
