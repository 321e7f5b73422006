#pragma once
/// EULUMDAT photometric files (.ldt; A. Stockmar 1990, revised 1998), with its field numbers.
///
/// In frame lamp, C plane 0 contains +X and γ counts from -Z, as in IES type C. But a long luminaire lies along C90 (y)
/// here, and along C0 (x) in IES files. If one file replaces the other, turn the fixture by 90°.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/files/luminous_opening.h"
#include "core/photometry/intensity.h"
#include "core/result.h"

namespace luxrig {

struct EulumdatFile {
  enum class Symmetry { none = 0, round = 1, about_c0_c180 = 2, about_c90_c270 = 3, both = 4 };  ///< field 3
  struct LampSet {                                                                               ///< field 26
    int lamps = 1;
    bool absolute = false;  ///< the number of lamps was negative: photometry of the luminaire, not of its lamps
    std::string type;
    double flux_lm = 0;  ///< of all its lamps
    std::string colour, colour_rendering;
    double watts = 0;  ///< ballast included
  };

  std::string company, name, number, file_name;
  Symmetry symmetry = Symmetry::none;
  std::vector<double> c_deg;                           ///< all planes, ascending from 0
  std::vector<double> gamma_deg;                       ///< ascending, 0…180
  std::vector<double> cd_per_klm;                      ///< [stored plane][gamma], as written
  double conversion_factor = 1;                        ///< field 24: multiplies the intensities
  double length_m = 0, width_m = 0, height_m = 0;      ///< of the body
  double luminous_length_m = 0, luminous_width_m = 0;  ///< width 0 = round, length is the diameter
  std::array<double, 4> luminous_height_m{};           ///< at C0, C90, C180, C270
  double downward_share = 0, light_output_ratio = 0;   ///< fields 22 and 23, 0…1
  double tilt_deg = 0;                                 ///< during the measurement
  std::vector<LampSet> lamp_sets;                      ///< alternatives; at least one
  std::array<double, 10> direct_ratios{};              ///< field 27
  std::vector<std::string> warnings;                   ///< for example if the flux contradicts LORL · lamp flux

  /// Planes held in cd_per_klm: stored_first() and the following ones, wrapping from the last to the first.
  [[nodiscard]] std::size_t stored_first() const;
  [[nodiscard]] std::size_t stored_planes() const;
};

/// Parses the text of a file: ISO 8859-1, UTF-8 or any encoding that keeps digits, or UTF-16, with or without
/// byte-order mark; decimal point or comma; trailing blanks. Text after the last intensity gives a warning. Empty
/// numbers among sizes, ratios and watts are 0. Refuses, with line and column:
/// - files that end early (naming the field)
/// - counts outside 1…10 000 or in conflict with the symmetry
/// - angles that do not ascend or do not reach the symmetry's planes
/// - values that are negative or not numbers
/// - files without a lamp set or without light
/// - radiometric files
/// `file_name` is for problems only.
[[nodiscard]] Checked<EulumdatFile> parse_eulumdat(std::string_view text, const std::string& file_name);

/// The distribution of a parsed file with one of its lamp sets [cd] = cd/klm · conversion factor · flux / 1000:
/// bilinear in C and γ, 0 outside the range of γ, mirrored by its symmetry.
/// requires a file returned by parse_eulumdat, and lamp_set < lamp_sets.size() (asserted)
[[nodiscard]] Intensity make_intensity(const EulumdatFile& file, std::size_t lamp_set = 0);

/// The luminous area (fields 16…21), width along x and length along y. A round one with height is a cylinder. A
/// rectangle with height loses its height.
[[nodiscard]] LuminousOpening luminous_opening(const EulumdatFile& file);

}  // namespace luxrig
