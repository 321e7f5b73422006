#pragma once
/// Pictures as PNG or JPEG files: tone mapping, false colour with its scale, plan views.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/picture/picture.h"
#include "tools/terminal/exposure.h"

namespace luxrig {

/// As a photograph: exposed and balanced by `look`, highlights rolled off (E. Reinhard et al. 2002, eq. 4), sRGB.
/// `title` is written in the corner; may be empty. PNG or JPEG, by the name's ending. Returns an empty string, or why
/// the file could not be written.
[[nodiscard]] std::string write_photograph(const Picture& picture, const std::string& title, const PhotographLook& look,
                                           const std::filesystem::path& file);

/// A photograph beside others.
struct Photograph {
  const Picture* picture;
  std::string title;
  PhotographLook look;
};
/// The same, side by side, on the height of the first.
[[nodiscard]] std::string write_photographs(std::span<const Photograph> photographs, const std::filesystem::path& file);

/// Illuminance in colours of the viridis scale, logarithmic, with lines of equal lux and a legend. max_lx (top of the
/// scale) defaults to the 99.5th percentile, rounded up to 1, 2 or 5 times a power of ten; the scale spans two decades.
[[nodiscard]] std::string write_false_colour(const Picture& picture, const std::string& title,
                                             std::optional<double> max_lx, const std::filesystem::path& file);

/// What colours stand for.
struct FalseColours {
  const char* unit = "lux";
  double decades = 2;          ///< of the scale
  std::optional<double> most;  ///< top of the scale; none = as above
  /// What is shown instead where a value is negative: grey, 0…1 for each pixel. Empty = black.
  std::span<const float> grey{};
};
/// The same as the bytes of a PNG; empty if memory runs out. Values: Picture::illuminance_lx, in any unit.
[[nodiscard]] std::string false_colour_png(const Picture& picture, const std::string& title,
                                           const FalseColours& colours);

/// The bytes of a PNG; empty if memory runs out.
[[nodiscard]] std::string plan_view_png(const PlanView& view);

/// Colour of the viridis scale at 0 … 1, sRGB 0 … 1: linear between nine of its table's entries.
[[nodiscard]] Vec3 viridis(double at);

/// Blue below the middle (0.5), nearly white in it, red above. People who cannot tell red from green can read it. The
/// scale RdBu of nine entries (C. Brewer, colorbrewer2.org), reversed.
[[nodiscard]] Vec3 blue_white_red(double at);

/// Smallest of 1, 2, 5 × 10^k that is at least `value` (> 0).
[[nodiscard]] double round_up_1_2_5(double value);

}  // namespace luxrig
