#pragma once
/// IES LM-63 photometric files (1986 … 2019), types A, B and C. Clauses as in ANSI/IES LM-63-2019.
///
/// Angles in frame lamp (LM-63-2002 §3, LM-75): type C counts γ from -Z upwards, and C from +X towards +Y
/// (counter-clockwise seen from above). In types A and B, horizontal angles turn clockwise. In type B, (0, 0) is -Z, V
/// rises from there towards +X, H goes towards -Y, and the half-planes of V meet in the horizontal axis Y:
///   direction = (cos H sin V, -sin H, -cos H cos V).
/// Type A is for luminaires with a level beam (headlamps, floodlights): its planes of X meet in the vertical, and
/// (0, 0) is the beam. Here, too, the beam is -Z of frame lamp, as for every head and spot. When it is aimed level,
/// that frame's +Y is up and its +X is to the right, seen along the beam. So Y still counts upwards and X to the right:
///   direction = (cos Y sin X, sin Y, -cos Y cos X).
/// Hung without an aim, such a luminaire shines down. Aim it level (aim_m, or tilt_deg = 90) for its measured
/// orientation.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/photometry/files/lamp_tilt.h"
#include "core/photometry/files/luminous_opening.h"
#include "core/photometry/intensity.h"
#include "core/result.h"

namespace luxrig {

/// Content of a file, before it becomes a distribution. Candela values include all factors.
struct IesFile {
  enum class Type { c = 1, b = 2, a = 3 };
  std::string edition;                ///< first line, "" for LM-63-1986
  std::vector<std::string> keywords;  ///< header lines in order: "[KEY] text", or free text in LM-63-1986
  Type type = Type::c;
  int lamps = 1;
  double lumens_per_lamp = -1;         ///< -1 = absolute photometry
  std::vector<double> vertical_deg;    ///< ascending; type C 0…180, A and B -90…90
  std::vector<double> horizontal_deg;  ///< ascending; type C 0…360, A and B -90…90
  /// [horizontal][vertical]: multiplier and factors applied, including the tilt factor of an upright luminaire
  std::vector<double> candela;
  double width_m = 0, length_m = 0, height_m = 0;  ///< luminous opening, signs as in the file
  double input_w = 0;
  std::optional<LampTilt> tilt;
  std::vector<std::string> warnings;  ///< for example if the flux contradicts the lamp lumens by more than 5 %
};

/// Text of the tilt file named by TILT=<name>; nullopt if there is none.
using TiltFiles = std::function<std::optional<std::string>(std::string_view name)>;

/// Parses the text of a file: UTF-8 or UTF-16, with or without byte-order mark. `file_name` is for problems only. Text
/// after the last candela value gives a warning. Refuses:
/// - radiometric files (W/sr: far-UVC sources)
/// - TILT from a file that `tilt_files` does not have
/// - counts outside 1…10 000 (at least two vertical angles, at most 4 million values)
/// - angles that do not ascend or fit no symmetry
/// - values that are negative or not finite
/// - files without any light
/// - decimal commas (each splits one number into two)
/// The last factor but one multiplies in LM-63-1986 and 1991 (ballast-lamp photometric factor). Later it is 1, and
/// since 2019 a code for the origin of the file.
[[nodiscard]] Checked<IesFile> parse_ies(std::string_view text, const std::string& file_name,
                                         const TiltFiles& tilt_files = {});

/// The distribution of a parsed file: bilinear in its two angles, 0 outside their range. Its flux is the exact integral
/// of that interpolant. Horizontal range of type C:
///   one plane   round about the axis
///   0…90        mirrored into four quadrants
///   0…180       mirrored about the plane 0–180
///   90…270      mirrored about the plane 90–270
///   0…360       as it is; also 0 and planes that stop one spacing short of 360
/// Types A and B: an angle from 0 is mirrored to negative ones; one horizontal angle = round about the
/// direction (0, 0).
/// requires a file returned by parse_ies.
[[nodiscard]] Intensity make_intensity(const IesFile& file);

/// The luminous opening by the signs of its sizes (LM-63-2002 table 1, and the forms of 1986…1995), length along x and
/// width along y, as the nearest available shape. A box with luminous sides becomes the rectangle at its bottom, an
/// ellipse the disk of its area, a lying cylinder the rectangle of its outline, an upright shape a point.
[[nodiscard]] LuminousOpening luminous_opening(const IesFile& file);

/// Tilt files in the folder of this path only.
[[nodiscard]] TiltFiles tilt_files_beside(const std::filesystem::path& path);

}  // namespace luxrig
