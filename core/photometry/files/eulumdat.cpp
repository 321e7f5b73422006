#include "core/photometry/files/eulumdat.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/photometry/files/file_text.h"

namespace luxrig {
namespace {

using namespace file_text;

constexpr std::size_t kMaxAngles = 10'000;
constexpr std::size_t kMaxValues = 4'000'000;
constexpr std::size_t kMaxLampSets = 100;
constexpr double kMaxLamps = 1e6;
constexpr double kMaxIntensity = 1e9;  // cd per 1000 lm
constexpr double kMinFlux_lm = 1e-6;   // below it, light is neither seen nor dimmed
constexpr double kMaxFlux_lm = 1e12;
constexpr double kFluxTolerance = 0.05;  // allowed difference of the integral from LORL · lamp flux

std::size_t stored_planes_of(EulumdatFile::Symmetry symmetry, std::size_t planes) {
  switch (symmetry) {
    case EulumdatFile::Symmetry::round:
      return 1;
    case EulumdatFile::Symmetry::about_c0_c180:
    case EulumdatFile::Symmetry::about_c90_c270:
      return planes / 2 + 1;
    case EulumdatFile::Symmetry::both:
      return planes / 4 + 1;
    default:
      return planes;
  }
}

/// One field a line.
class EulumdatParser {
 public:
  EulumdatParser(std::string_view text, const std::string& file_name)
      : cursor_(without_bom(text)), problems_(file_name) {}

  Checked<EulumdatFile> parse() {
    if (!parse_all() || !problems_.empty()) return tl::unexpected(problems_.take());
    if (const std::string rest = words_of_rest(cursor_, "the last intensity"); !rest.empty())
      file_.warnings.push_back(rest);
    return std::move(file_);
  }

 private:
  bool parse_all() {
    return parse_head() && parse_sizes() && parse_lamp_sets() && parse_grid() && check_planes() && check_flux();
  }

  std::optional<std::string_view> line(const std::string& what) {
    if (cursor_.at_end()) {
      problems_.add(cursor_.at(), "the file ends before the " + what, "give the whole file");
      return std::nullopt;
    }
    return trimmed(cursor_.take_line());
  }

  bool text(const std::string& what, std::string& out) {
    const At at = cursor_.at();
    const auto field = line(what);
    if (!field) return false;
    out = std::string(*field);
    if (!is_radiometric(lower(out))) return true;
    problems_.add(at, "radiometric data " + excerpt(out) + ", not candela",
                  "give the file of a visible-light luminaire, in candela");
    return false;
  }

  /// A number on its own line. `empty_is_0`: many writers leave sizes and similar fields blank. False if the file has
  /// ended or the line holds no number. A number out of range is a problem, but reading continues.
  bool number(const std::string& what, double least, double most, double& out, bool empty_is_0 = false) {
    const At at = cursor_.at();
    const auto field = line(what);
    if (!field) return false;
    if (field->empty() && empty_is_0) {
      out = 0;
      return true;
    }
    std::string digits(*field);
    std::replace(digits.begin(), digits.end(), ',', '.');
    const std::optional<double> value = number_of(digits);
    if (!value) {
      problems_.add(at, what + (field->empty() ? std::string(" is empty") : " " + excerpt(*field) + " is not a number"),
                    "write one number on the line");
      return false;
    }
    if (*value < least || *value > most) {
      problems_.add(at, what + " " + excerpt(*field) + " is out of range",
                    "give a value from " + number_text(least) + " to " + number_text(most));
    }
    out = *value;
    return true;
  }

  bool whole(const std::string& what, double least, double most, double& out) {
    const At at = cursor_.at();
    const std::size_t before = problems_.size();
    if (!number(what, least, most, out)) return false;
    if (problems_.size() > before || problems_.full()) {
      out = least;
    } else if (out != std::floor(out)) {
      problems_.add(at, what + " is not a whole number", "write a whole number");
      out = least;
    }
    return true;
  }

  bool parse_head() {
    std::string ignored;
    double type = 0, symmetry = 0, planes = 0, step = 0, gammas = 0;
    if (!text("company", file_.company) || !whole("type of luminaire (field 2)", 0, 3, type) ||
        !whole("symmetry (field 3)", 0, 4, symmetry) || !whole("number of C planes (field 4)", 1, kMaxAngles, planes) ||
        !number("distance of C planes (field 5)", 0, 360, step, true) ||
        !whole("number of angles in a plane (field 6)", 1, kMaxAngles, gammas) ||
        !number("distance of angles (field 7)", 0, 180, step, true) || !text("report number", ignored) ||
        !text("luminaire name", file_.name) || !text("luminaire number", file_.number) ||
        !text("file name", file_.file_name) || !text("date", ignored)) {
      return false;
    }
    if (!problems_.empty()) return false;
    planes_ = static_cast<std::size_t>(planes);
    gammas_ = static_cast<std::size_t>(gammas);
    file_.symmetry = static_cast<EulumdatFile::Symmetry>(static_cast<int>(symmetry));
    if (planes_ == 1) file_.symmetry = EulumdatFile::Symmetry::round;  // there is one plane, whatever field 3 says
    const std::size_t multiple = file_.symmetry == EulumdatFile::Symmetry::about_c0_c180 ? 2
                                 : static_cast<int>(file_.symmetry) >= 3                 ? 4
                                                                                         : 1;
    if (planes_ % multiple != 0) {
      problems_.add({4, 1},
                    "number of C planes " + number_text(planes) + " does not fit symmetry " + number_text(symmetry),
                    "give a multiple of " + std::to_string(multiple) + ", or the symmetry that the planes have");
    }
    if (gammas_ < 2) problems_.add({6, 1}, "one angle in a plane makes no distribution", "give two or more");
    if (stored_planes_of(file_.symmetry, planes_) * gammas_ > kMaxValues) {
      problems_.add({4, 1}, "more than 4 million values", "give a coarser grid");
    }
    return problems_.empty();
  }

  bool length(const std::string& what, double& out_m) {
    double mm = 0;
    if (!number(what, 0, 1e6, mm, true)) return false;
    out_m = 1e-3 * mm;
    return true;
  }

  bool parse_sizes() {
    double downward = 0, ratio = 0;
    bool read = length("length (field 13)", file_.length_m) && length("width (field 14)", file_.width_m) &&
                length("height (field 15)", file_.height_m) &&
                length("luminous length (field 16)", file_.luminous_length_m) &&
                length("luminous width (field 17)", file_.luminous_width_m);
    for (int i = 0; i < 4 && read; ++i) {
      read = length("luminous height (field " + std::to_string(18 + i) + ")",
                    file_.luminous_height_m[static_cast<std::size_t>(i)]);
    }
    const At factor_at{24, 1};
    if (!read || !number("downward flux fraction (field 22)", 0, 1000, downward, true) ||
        !number("light output ratio (field 23)", 0, 1000, ratio, true) ||
        !number("conversion factor (field 24)", 0, 1e6, file_.conversion_factor) ||
        !number("tilt (field 25)", -360, 360, file_.tilt_deg, true)) {
      return false;
    }
    file_.downward_share = 0.01 * downward;
    file_.light_output_ratio = 0.01 * ratio;
    if (file_.conversion_factor == 0) problems_.add(factor_at, "the conversion factor is 0", "give it, usually 1");
    return true;
  }

  bool parse_lamp_sets() {
    double sets = 0;
    if (!whole("number of lamp sets (field 26)", 1, kMaxLampSets, sets)) return false;
    if (!problems_.empty()) return false;
    for (int i = 0; i < static_cast<int>(sets); ++i) {
      EulumdatFile::LampSet set;
      double lamps = 0;
      const At lamps_at = cursor_.at();
      if (!number("number of lamps (field 26a)", -kMaxLamps, kMaxLamps, lamps) || !text("lamp type", set.type))
        return false;
      const At flux_at = cursor_.at();
      if (!number("lamp flux (field 26c)", 0, kMaxFlux_lm, set.flux_lm) || !text("lamp colour", set.colour) ||
          !text("colour rendering", set.colour_rendering) ||
          !number("lamp watts (field 26f)", 0, 1e9, set.watts, true)) {
        return false;
      }
      if (lamps == 0 || lamps != std::floor(lamps)) {
        problems_.add(lamps_at, "number of lamps " + number_text(lamps) + " is no count",
                      "give a whole number; negative for absolute photometry");
      }
      if (!(set.flux_lm > 0)) problems_.add(flux_at, "the lamp flux is 0", "give the lumens of the lamps");
      set.absolute = lamps < 0;
      set.lamps = static_cast<int>(std::min(std::abs(lamps), kMaxLamps));
      file_.lamp_sets.push_back(std::move(set));
    }
    for (double& ratio : file_.direct_ratios) {
      if (!number("direct ratio (field 27)", -1e3, 1e3, ratio, true)) return false;
    }
    return problems_.empty();
  }

  bool numbers(const std::string& what, std::size_t count, double most, std::vector<double>& out) {
    out.reserve(std::min(count, cursor_.remaining() / 2 + 1));  // never more than the text can hold
    for (std::size_t i = 0; i < count; ++i) {
      double value = 0;
      if (!number(what + " " + std::to_string(i + 1) + " of " + std::to_string(count), 0, most, value)) return false;
      if (problems_.full()) return false;
      out.push_back(value);
    }
    return problems_.empty();
  }

  bool parse_grid() {
    c_at_ = cursor_.at();
    if (!numbers("C angle", planes_, 360, file_.c_deg)) return false;
    const At gamma_at = cursor_.at();
    if (!numbers("gamma angle", gammas_, 180, file_.gamma_deg) ||
        !check_ascending("gamma", file_.gamma_deg, gamma_at, problems_)) {
      return false;
    }
    const double first = file_.gamma_deg.front();
    const double last = file_.gamma_deg.back();
    if ((first != 0 && first != 90) || (last != 90 && last != 180)) {
      file_.warnings.push_back("gamma angles " + number_text(first) + " to " + number_text(last) +
                               " degrees; no light is assumed outside");
    }
    intensity_at_ = cursor_.at();
    return numbers("intensity", stored_planes_of(file_.symmetry, planes_) * gammas_, kMaxIntensity, file_.cd_per_klm);
  }

  /// The symmetry's planes must be at the right angles.
  bool check_planes() {
    if (file_.symmetry == EulumdatFile::Symmetry::round) return true;
    if (!check_ascending("C", file_.c_deg, c_at_, problems_)) return false;
    const auto expect = [&](std::size_t plane, double deg) {
      if (std::abs(file_.c_deg[plane] - deg) <= 1e-6) {
        file_.c_deg[plane] = deg;
        return;
      }
      problems_.add({c_at_.line + static_cast<int>(plane), 1},
                    "C plane " + std::to_string(plane + 1) + " of " + std::to_string(planes_) + " is at " +
                        number_text(file_.c_deg[plane]) + ", where the symmetry needs " + number_text(deg),
                    "list all C planes from 0, or correct the symmetry");
    };
    expect(0, 0);
    const int symmetry = static_cast<int>(file_.symmetry);
    if (symmetry == 2) expect(planes_ / 2, 180);
    if (symmetry >= 3) expect(planes_ / 4, 90);
    if (symmetry == 3) expect(planes_ / 4 * 3, 270);
    if (symmetry == 0 && file_.c_deg.back() < 180) {
      problems_.add(c_at_, "C planes end at " + number_text(file_.c_deg.back()) + " without a symmetry",
                    "list all C planes of the turn, or state the symmetry");
    }
    return problems_.empty();
  }

  bool check_flux() {
    const double largest = *std::max_element(file_.cd_per_klm.begin(), file_.cd_per_klm.end());
    const auto& set = file_.lamp_sets.front();
    const double scale = file_.conversion_factor * set.flux_lm / 1000;
    const double flux_lm = 4 * kPi * largest * scale < kMinFlux_lm ? 0 : make_intensity(file_)->flux_lm();
    if (!(flux_lm >= kMinFlux_lm) || !(flux_lm <= kMaxFlux_lm)) {
      problems_.add(intensity_at_,
                    "the luminaire gives " + std::string(flux_lm > 1 ? "too much" : "no") +
                        " light: " + number_text(flux_lm) + " lm",
                    "correct intensities, conversion factor and lamp flux");
      return false;
    }
    const double stated_lm = file_.light_output_ratio * set.flux_lm;
    if (stated_lm > 0 && std::abs(flux_lm / stated_lm - 1) > kFluxTolerance) {
      file_.warnings.push_back("the distribution holds " + number_text(flux_lm) + " lm, but " +
                               number_text(100 * file_.light_output_ratio) + " % of the lamps' flux is " +
                               number_text(stated_lm) + " lm");
    }
    if (file_.lamp_sets.size() > 1) {
      file_.warnings.push_back(std::to_string(file_.lamp_sets.size()) + " lamp sets; the first is used, " +
                               number_text(set.flux_lm) + " lm");
    }
    return true;
  }

  Cursor cursor_;
  ProblemLog problems_;
  EulumdatFile file_;
  std::size_t planes_ = 0;
  std::size_t gammas_ = 0;
  At c_at_, intensity_at_;
};

}  // namespace

std::size_t EulumdatFile::stored_first() const {
  return symmetry == Symmetry::about_c90_c270 ? c_deg.size() / 4 * 3 : 0;
}

std::size_t EulumdatFile::stored_planes() const { return stored_planes_of(symmetry, c_deg.size()); }

Checked<EulumdatFile> parse_eulumdat(std::string_view text, const std::string& file_name) {
  const std::optional<std::string> decoded = from_utf16(text);
  return EulumdatParser(decoded ? std::string_view(*decoded) : text, file_name).parse();
}

}  // namespace luxrig
