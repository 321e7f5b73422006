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
  std::vector<std::string> keywords;  ///< "[KEY] text", in order
  int lamps = 1;
  double lumens_per_lamp = -1;                     ///< -1 = absolute photometry
  std::vector<double> vertical_deg;                ///< ascending
  std::vector<double> horizontal_deg;              ///< ascending
  std::vector<double> candela;                     ///< [horizontal][vertical], multiplier and factors applied
  double width_m = 0, length_m = 0, height_m = 0;  ///< luminous opening, signs as in the file
  double input_w = 0;
  std::vector<std::string> warnings;  ///< e.g. flux contradicts the lamp lumens by more than 5 %
};

/// Parses the text of a file. `file_name` is only for problems. Refuses what is not type C photometry.
[[nodiscard]] Checked<IesFile> parse_ies(std::string_view text, const std::string& file_name);

/// The distribution of a parsed file: bilinear between angles, symmetry by the horizontal range,
/// 0 outside the vertical range.
[[nodiscard]] Intensity make_intensity(const IesFile& file);

/// Reads and parses. Refuses files over 64 MiB.
[[nodiscard]] Checked<IesFile> load_ies(const std::filesystem::path& path);

}  // namespace luxrig
