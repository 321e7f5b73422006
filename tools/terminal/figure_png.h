#pragma once
/// A picture with what it takes to read it: title, scale, key, names in it.

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

/// In the picture: the mark at the place, the words beside it, within the picture.
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

/// Title and caption above the picture, scale and key in a column on its right: the file is kFigureColumn_px wider
/// than the picture, and as much higher as words need. Returns an empty string, or why it could not be written.
inline constexpr int kFigureColumn_px = 170;
[[nodiscard]] std::string write_figure(const Figure& figure, const std::filesystem::path& file);

/// Values for a scale's ticks: multiples of 1, 2 or 5 × 10^k, at most `most` of them (≥ 2), bottom and top included
/// where they are some.
[[nodiscard]] std::vector<double> even_ticks(double bottom, double top, int most);

}  // namespace luxrig
