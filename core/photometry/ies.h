#pragma once
/// IES LM-63 photometric files (1986 … 2019), type C. Clauses as in ANSI/IES LM-63-2019.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/intensity.h"
#include "core/result.h"

namespace luxrig {

/// What a file says, before it becomes a distribution. Candela values have all factors applied.
struct IesFile {
  std::string edition;                ///< first line, "" for LM-63-1986
  std::vector<std::string> keywords;  ///< header lines in order: "[KEY] text", or free text in LM-63-1986
  int lamps = 1;
  double lumens_per_lamp = -1;                     ///< -1 = absolute photometry
  std::vector<double> vertical_deg;                ///< ascending
  std::vector<double> horizontal_deg;              ///< ascending
  std::vector<double> candela;                     ///< [horizontal][vertical], multiplier and factors applied
  double width_m = 0, length_m = 0, height_m = 0;  ///< luminous opening, signs as in the file
  double input_w = 0;
  std::vector<std::string> warnings;  ///< e.g. flux contradicts the lamp lumens by more than 5 %
};

/// Parses the text of a file. `file_name` is only for problems. Refuses what is not type C photometry: types
/// A and B, radiometric files (W/sr), TILT from another file; and what no luminaire is: counts outside 1…10 000
/// (at least two vertical angles, at most 4 million values), angles that do not ascend or fit no symmetry,
/// values that are negative or not finite, no light at all. Numbers after the last candela value are ignored.
/// TILT=INCLUDE: the factor for a lamp that is not tilted (0°) is applied, with a warning when others differ.
[[nodiscard]] Checked<IesFile> parse_ies(std::string_view text, const std::string& file_name);

/// The distribution of a parsed file: bilinear in the two angles, 0 outside the vertical range. Symmetry by the
/// horizontal range: one plane = round about the axis; 0…90 = mirrored into four quadrants; 0…180 = mirrored
/// about the plane 0–180; 90…270 = mirrored about the plane 90–270; 0…360, or 0 and planes that stop one
/// spacing short of 360 = as it is. Its flux is the exact integral of that interpolant.
/// requires a file that parse_ies returned.
[[nodiscard]] Intensity make_intensity(const IesFile& file);

/// Reads and parses. Refuses files over 64 MiB.
[[nodiscard]] Checked<IesFile> load_ies(const std::filesystem::path& path);

}  // namespace luxrig
