#pragma once
/// A picture with everything needed to read it: title, scale, key, labels.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/highlight/picture/surface_picture.h"

namespace luxrig {

struct FigureScale {
  std::string what;                           ///< with its unit
  double bottom = 0, top = 1;                 ///< top > bottom
  std::function<Vec3(double at)> colour;      ///< at 0…1, sRGB
  std::string words_at_top, words_at_bottom;  ///< may be empty
};

enum class FigureMark { none, dot, ring, diamond, cross, line };

struct FigureKey {
  FigureMark mark = FigureMark::none;
  Vec3 rgb = Vec3::Zero();
  std::string words;
};

/// A mark at a place in the picture, with words beside it; both stay within the picture.
struct FigureLabel {
  double x_px = 0, y_px = 0;
  FigureMark mark = FigureMark::none;
  Vec3 rgb = Vec3::Zero();
  std::string words;
};

struct Figure {
  ColourPicture picture;
  std::string title, caption;  ///< the caption is broken into lines
  std::optional<FigureScale> scale;
  std::vector<FigureKey> key;
  std::vector<FigureLabel> labels;
};

/// Title and caption above the picture, scale and key in a column on its right. The file is kFigureColumn_px wider than
/// the picture, and higher by the height of the words. Returns an empty string, or why it could not be written.
inline constexpr int kFigureColumn_px = 170;
[[nodiscard]] std::string write_figure(const Figure& figure, const std::filesystem::path& file);

/// Values for a scale's ticks: multiples of 1, 2 or 5 × 10^k, at most `most` (≥ 2). Bottom and top are included if they
/// are such multiples.
[[nodiscard]] std::vector<double> even_ticks(double bottom, double top, int most);

}  // namespace luxrig
