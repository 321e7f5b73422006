#include "core/photometry/files/ies.h"

#include <algorithm>
#include <utility>

#include "core/photometry/files/file_text.h"
#include "core/photometry/files/ies_angles.h"

namespace luxrig {
namespace {

using namespace file_text;

constexpr std::size_t kMaxIesAngles = 10'000;
constexpr std::size_t kMaxIesValues = 4'000'000;
constexpr double kMaxCandela = 1e12;        // a lighthouse has 1e7
constexpr double kMinIesFlux_lm = 1e-6;     // below it, light is neither seen nor dimmed
constexpr double kIesFluxTolerance = 1.05;  // factor by which photometry may exceed its lamps' lumens
constexpr double kMetresPerFoot = 0.3048;

class IesParser {
 public:
  IesParser(std::string_view text, const std::string& file_name, const TiltFiles& tilt_files)
      : cursor_(without_bom(text)), problems_(file_name), read_(cursor_, problems_), tilt_files_(tilt_files) {}

  Checked<IesFile> parse() {
    const bool read = parse_all() && problems_.empty();
    const std::string rest = read ? words_of_rest(cursor_, "the last candela value") : "";
    // Each decimal comma splits one number into two. Then numbers are left over, or their counts make no sense.
    if (numbers_from_ && (!read || !rest.empty()) && add_decimal_comma()) return tl::unexpected(problems_.take());
    if (!read) return tl::unexpected(problems_.take());
    if (!rest.empty()) file_.warnings.push_back(rest);
    return std::move(file_);
  }

 private:
  /// Looks for commas between digits in a file whose numbers are separated by blanks. Reports the first one, instead of
  /// the errors from reading it as two numbers.
  bool add_decimal_comma() {
    Cursor cursor = *numbers_from_;
    std::optional<At> at;
    std::string found;
    while (!cursor.at_end()) {
      while (!cursor.at_end() && static_cast<unsigned char>(cursor.peek()) <= ' ') cursor.advance();
      const At start = cursor.at();
      std::string word;
      while (!cursor.at_end() && static_cast<unsigned char>(cursor.peek()) > ' ') {
        word += cursor.peek();
        cursor.advance();
      }
      const std::size_t comma = word.find(',');
      if (comma == std::string::npos) continue;
      const std::string whole = word.substr(0, comma), decimals = word.substr(comma + 1);
      const bool decimal = number_of(whole) && !decimals.empty() &&
                           decimals.find_first_not_of("0123456789eE+-") == std::string::npos &&
                           whole.find('.') == std::string::npos;
      if (!decimal) return false;  // commas are separators in this file
      if (!at) at = start, found = word;
    }
    if (!at) return false;
    problems_.clear();
    problems_.add(*at, "number " + excerpt(found) + " has a decimal comma, and a comma separates numbers here",
                  "write decimal points in the whole file");
    return true;
  }

  bool parse_all() {
    const auto tilt = parse_header();
    if (!tilt || !problems_.empty()) return false;
    if (!parse_tilt(*tilt)) return false;
    numbers_from_ = cursor_;
    return parse_fields() && parse_angles() && parse_candela() && check_flux();
  }

  /// Reads up to "TILT="; the cursor is then after the '='. Returns the start of that line.
  std::optional<At> parse_header() {
    bool first = true;
    while (!cursor_.at_end()) {
      const At at = cursor_.at();
      Cursor line_start = cursor_;
      const std::string_view line = trimmed(cursor_.take_line());
      const std::string small = lower(line);
      if (small.rfind("tilt", 0) == 0) {
        const std::size_t equals = small.find_first_not_of(" \t", 4);
        if (equals != std::string::npos && small[equals] == '=') {
          cursor_ = line_start;
          while (cursor_.peek() != '=') cursor_.advance();
          cursor_.advance();
          return at;
        }
      }
      if (first && small.rfind("ies", 0) == 0) {
        file_.edition = std::string(line);
      } else if (!line.empty()) {
        // Far-UVC makers use this format with mW for lm. Read as candela, it would be light that nobody sees.
        if (is_radiometric(small)) {
          problems_.add(at, "radiometric data " + excerpt(line) + ", not candela",
                        "give the file of a visible-light luminaire, in candela");
          return std::nullopt;
        }
        file_.keywords.emplace_back(line);
      }
      first = false;
    }
    problems_.add({1, 1}, "no TILT= line: not an IES LM-63 file",
                  "give a photometric file whose header ends with TILT=NONE");
    return std::nullopt;
  }

  bool parse_tilt(At at) {
    Cursor line_start = cursor_;
    const std::string value(cursor_.take_token());
    const std::string small = lower(value);
    if (small == "none") return true;
    if (small == "include") return parse_tilt_section(cursor_, problems_);
    const std::string name(trimmed(line_start.take_line()));  // may contain blanks
    const std::optional<std::string> text = tilt_files_ ? tilt_files_(name) : std::nullopt;
    if (!text) {
      problems_.add(at, "TILT factors in another file, " + excerpt(name) + ", that is not here",
                    "put it beside this file, or write them into this file with TILT=INCLUDE");
      return false;
    }
    cursor_ = line_start;
    Cursor cursor(*text);
    ProblemLog problems(name);
    if (parse_tilt_section(cursor, problems)) return true;
    for (Problem& problem : problems.take()) {
      problems_.add(at, "tilt file " + excerpt(name) + ", line " + std::to_string(problem.line) + ": " + problem.what,
                    problem.mend);
    }
    return false;
  }

  bool parse_tilt_section(Cursor& cursor, ProblemLog& problems) {
    NumberReader read(cursor, problems);
    LampTilt tilt;
    const auto geometry = read.whole("lamp-to-luminaire geometry", 1, 3);
    const auto count = read.whole("number of tilt angles", 1, kMaxIesAngles);
    if (!geometry || !count || !problems.empty()) return false;
    tilt.geometry = static_cast<int>(*geometry);
    const At angles_at = read.place();
    if (!read.numbers("tilt angle", *count, 0, 180, tilt.angle_deg) ||
        !check_ascending("tilt", tilt.angle_deg, angles_at, problems) ||
        !read.numbers("tilt factor", *count, 0.001, 10, tilt.factor)) {
      return false;
    }
    upright_factor_ = tilt.factor.front();
    const auto [least, most] = std::minmax_element(tilt.factor.begin(), tilt.factor.end());
    if (*least != *most) file_.warnings.push_back("lamp output depends on tilt: rated flux is that of an upright lamp");
    file_.tilt = std::move(tilt);
    return true;
  }

  bool parse_fields() {
    const auto lamps = read_.whole("number of lamps", 1, 1'000'000);
    const At lumens_at = read_.place();
    const auto lumens = read_.number("lumens per lamp", -1, 1e12);
    const At factor_at = read_.place();
    const auto multiplier = read_.number("candela multiplier", 0, 1e9);
    const At counts_at = read_.place();
    const auto vertical = read_.whole("number of vertical angles", 1, kMaxIesAngles);
    const auto horizontal = read_.whole("number of horizontal angles", 1, kMaxIesAngles);
    const auto type = read_.whole("photometric type", 1, 3);
    const auto units = read_.whole("units type", 1, 2);
    const auto width = read_.number("luminous width", -1e6, 1e6);
    const auto length = read_.number("luminous length", -1e6, 1e6);
    const auto height = read_.number("luminous height", -1e6, 1e6);
    const auto ballast = read_.number("ballast factor", 0, 1e6);
    const auto second = read_.number("ballast-lamp photometric factor", 0, 1e6);
    const auto watts = read_.number("input watts", 0, 1e9);
    if (!watts || !problems_.empty()) return false;  // `watts` is the last: without it, the stream ended or broke
    factor_at_ = factor_at;
    if (*vertical < 2) problems_.add(counts_at, "one vertical angle makes no distribution", "give two or more");
    if (*vertical * *horizontal > kMaxIesValues) {
      problems_.add(counts_at,
                    std::to_string(*vertical) + " x " + std::to_string(*horizontal) + " values, more than 4 million",
                    "give a coarser grid");
    }
    if (*lumens < 0 && *lumens != -1) {
      problems_.add(lumens_at, "lumens per lamp is negative", "give lumens, or -1 for absolute photometry");
    }
    factor_ = *multiplier * *ballast * upright_factor_;
    const std::string edition = lower(file_.edition);
    const bool early = edition.empty() || (edition.size() >= 2 && (edition.substr(edition.size() - 2) == "91" ||
                                                                   edition.substr(edition.size() - 2) == "86"));
    if (early) factor_ *= *second;
    if (!(factor_ > 0)) {
      problems_.add(factor_at, "a multiplier or ballast factor is 0", "give the true factor, usually 1");
    }
    const double metres = *units == 1 ? kMetresPerFoot : 1.0;
    file_.type = static_cast<IesFile::Type>(*type);
    file_.lamps = static_cast<int>(*lamps);
    file_.lumens_per_lamp = *lumens;
    file_.width_m = *width * metres;
    file_.length_m = *length * metres;
    file_.height_m = *height * metres;
    file_.input_w = *watts;
    verticals_ = *vertical;
    horizontals_ = *horizontal;
    return problems_.empty();
  }

  bool parse_angles() {
    const bool c = file_.type == IesFile::Type::c;
    const At vertical_at = read_.place();
    if (!read_.numbers("vertical angle", verticals_, c ? 0 : -90, c ? 180 : 90, file_.vertical_deg)) return false;
    const At horizontal_at = read_.place();
    if (!read_.numbers("horizontal angle", horizontals_, c ? 0 : -90, c ? 360 : 90, file_.horizontal_deg)) return false;
    check_ascending("vertical", file_.vertical_deg, vertical_at, problems_);
    check_ascending("horizontal", file_.horizontal_deg, horizontal_at, problems_);
    return problems_.empty() && check_ies_angles(file_, vertical_at, horizontal_at, problems_, file_.warnings);
  }

  bool parse_candela() {
    candela_at_ = read_.place();
    if (!read_.numbers("candela value", verticals_ * horizontals_, 0, kMaxCandela, file_.candela)) return false;
    for (double& value : file_.candela) {
      value *= factor_;
      if (value > kMaxCandela) {
        problems_.add(factor_at_, "candela values with their factors exceed 1e12",
                      "correct the multiplier and ballast factor");
        return false;
      }
    }
    return true;
  }

  bool check_flux() {
    const double largest_cd = *std::max_element(file_.candela.begin(), file_.candela.end());
    const double flux_lm = 4 * kPi * largest_cd < kMinIesFlux_lm ? 0 : make_intensity(file_)->flux_lm();
    if (!(flux_lm >= kMinIesFlux_lm)) {
      problems_.add(candela_at_, "the luminaire gives no light: " + number_text(flux_lm) + " lm",
                    "give a file with candela values");
      return false;
    }
    const double lamps_lm = file_.lumens_per_lamp * file_.lamps;
    if (lamps_lm >= 0 && flux_lm > kIesFluxTolerance * lamps_lm) {
      file_.warnings.push_back("the distribution holds " + number_text(flux_lm) + " lm, its lamps only " +
                               number_text(lamps_lm) + " lm");
    }
    return true;
  }

  Cursor cursor_;
  ProblemLog problems_;
  NumberReader read_;
  const TiltFiles& tilt_files_;
  IesFile file_;
  double upright_factor_ = 1;
  double factor_ = 1;
  std::size_t verticals_ = 0;
  std::size_t horizontals_ = 0;
  std::optional<Cursor> numbers_from_;
  At factor_at_, candela_at_;
};

}  // namespace

Checked<IesFile> parse_ies(std::string_view text, const std::string& file_name, const TiltFiles& tilt_files) {
  const std::optional<std::string> decoded = from_utf16(text);
  return IesParser(decoded ? std::string_view(*decoded) : text, file_name, tilt_files).parse();
}

TiltFiles tilt_files_beside(const std::filesystem::path& path) {
  return [path](std::string_view name) -> std::optional<std::string> {
    // Names are untrusted: only files in the folder itself.
    if (name.empty() || name.find_first_of("/\\:") != std::string_view::npos || name.front() == '.') return {};
    const Checked<std::string> tilt = read_text(path.parent_path() / std::string(name), "tilt");
    return tilt ? std::optional(*tilt) : std::nullopt;
  };
}

}  // namespace luxrig
